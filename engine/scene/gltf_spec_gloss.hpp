// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "scene/gltf_file.hpp"
#include "scene/spec_gloss.hpp"

namespace sheaf {

/// A material of KHR_materials_pbrSpecularGlossiness whose textures are still to be converted.
struct SpecGlossMaterial {
  std::size_t material = 0;
  SpecGloss factors;
  TextureUse diffuse, specular_glossiness;
};

/// Once the images are decoded: gives each material textures of its own, and drops those that nothing uses any more.
void convert_spec_gloss(const GltfFile& file, const std::vector<SpecGlossMaterial>& materials, Scene& scene);

}  // namespace sheaf
