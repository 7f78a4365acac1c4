// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "scene/gltf_file.hpp"

namespace sheaf {

/// Sorts what the file says it uses into extensions that are read and that are ignored, with a warning for each of the
/// latter; refuses what it requires and this build cannot read.
void check_extensions(GltfFile& file);

/// Whether this build reads the extension.
[[nodiscard]] bool reads_extension(std::string_view name);

}  // namespace sheaf
