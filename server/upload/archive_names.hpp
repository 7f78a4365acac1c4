// SPDX-License-Identifier: MIT
// The names in a client's archive: file managers make archives of a folder or of its contents, and add files of their
// own.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace sheaf::server {

/// Files that file managers add: __MACOSX/…, ._NAME (AppleDouble), .DS_Store, Icon\r, Thumbs.db,
/// desktop.ini.
[[nodiscard]] bool is_file_manager_metadata(std::string_view name);

[[nodiscard]] bool is_scene_name(const std::filesystem::path& path);

/// The scene of an archive, in whatever folder; of several, the one whose folder contains all the others. Throws
/// Problem (422) if there is none, or if several qualify.
[[nodiscard]] std::filesystem::path find_scene(std::vector<std::filesystem::path> scenes);

}  // namespace sheaf::server
