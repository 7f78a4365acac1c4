// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace sheaf::server {

/// A client's relative path ("textures/wood.png") that stays inside the folder it is put in. A backslash separates as
/// '/' does, and "." is left out. Throws Problem (422) for an absolute one, a drive, "..", control characters, empty or
/// overlong parts.
[[nodiscard]] std::filesystem::path safe_relative_path(std::string_view given);

/// The last part alone: some clients send their whole path.
[[nodiscard]] std::string base_name(std::string_view given);

/// ".glb" in lower case; empty if there is none.
[[nodiscard]] std::string extension_of(std::string_view name);

}  // namespace sheaf::server
