// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "jobs/limits.hpp"

namespace sheaf::server {

/// Unpacks a client's archive into `folder`, which is its own. Names stay inside it; links, encryption and methods
/// other than stored and deflated are refused; entries, bytes and ratio are bounded by the actual output, not by
/// the archive's directory. Files that file managers add are skipped. Returns the scene's path in the folder
/// (find_scene). Throws Problem: 422 for a bad archive, 413 past a limit.
[[nodiscard]] std::filesystem::path unzip_scene(const std::filesystem::path& archive,
                                                const std::filesystem::path& folder, const Limits& limits);

}  // namespace sheaf::server
