// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "scene/gltf_file.hpp"

namespace sheaf {

/// Names of the file's KHR_materials_variants, in their order.
[[nodiscard]] std::vector<std::string> variant_names(const GltfFile& file);

/// Gives primitives the materials of a variant, chosen by name or index; by an empty `selector` nothing changes.
void choose_variant(GltfFile& file, const std::string& selector);

}  // namespace sheaf
