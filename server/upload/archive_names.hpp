// SPDX-License-Identifier: MIT
// What the names in a client's archive stand for: archives are made by file managers, of a folder or of what is in it.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace sheaf::server {

/// Files that file managers add of their own: __MACOSX/…, ._NAME (AppleDouble), .DS_Store, Icon\r, Thumbs.db,
/// desktop.ini.
[[nodiscard]] bool is_file_managers(std::string_view name);

[[nodiscard]] bool is_scene_name(const std::filesystem::path& path);

/// The one scene of an archive, wherever it lies; of several, the one whose folder holds all the others. Throws Problem
/// (422) where there is none, or none that stands out.
[[nodiscard]] std::filesystem::path only_scene(std::vector<std::filesystem::path> scenes);

}  // namespace sheaf::server
