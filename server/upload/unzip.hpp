// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "jobs/limits.hpp"

namespace sheaf::server {

/// Unpacks a client's archive into `folder`, which is its own. Names stay inside it; links, encryption and methods
/// other than stored and deflated are refused; entries, bytes and ratio are bounded by what really comes out, not by
/// what the archive says. What file managers add is left out. Returns where in the folder the scene lies (only_scene).
/// Throws Problem: 422 for a bad archive, 413 past a limit.
[[nodiscard]] std::filesystem::path unzip_scene(const std::filesystem::path& archive,
                                                const std::filesystem::path& folder, const Limits& limits);

}  // namespace sheaf::server
