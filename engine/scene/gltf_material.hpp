// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf_file.hpp"
#include "scene/scene.hpp"

namespace sheaf {

/// Materials (the default one after the file's own), and the textures and images that they use: those alone are
/// decoded. Of a material that is not marked in `used` only the name is read.
void load_materials(GltfFile& file, const std::vector<bool>& used, Scene& scene);

}  // namespace sheaf
