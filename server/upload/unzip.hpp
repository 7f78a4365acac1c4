// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "jobs/limits.hpp"

namespace sheaf::server {

/// Unpacks a client's archive into `folder`, which is its own. Names stay inside it; links, encryption and methods
/// other than stored and deflated are refused; entries, bytes and ratio are bounded by what really comes out, not by
/// what the archive says. Returns the name of the one .glb or .gltf at the top.
/// Throws Problem: 422 for a bad archive, 413 past a limit.
[[nodiscard]] std::string unzip_scene(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                      const Limits& limits);

}  // namespace sheaf::server
