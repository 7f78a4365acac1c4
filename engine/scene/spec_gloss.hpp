// SPDX-License-Identifier: MIT
// KHR_materials_pbrSpecularGlossiness as the metallic-roughness material that comes nearest.
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace sheaf {

struct SpecGloss {  // linear
  glm::vec4 diffuse{1};
  glm::vec3 specular{1};
  float glossiness = 1;
};

struct MetalRough {
  glm::vec4 base_color{1};
  float metallic = 0, roughness = 0;
};

[[nodiscard]] MetalRough to_metal_rough(const SpecGloss& surface);

struct MetalRoughImages {
  Image base_color, metallic_roughness;  // as glTF stores them
};

/// Texel by texel, factors included, in the size of the larger image. Either image may be null: 1 everywhere.
[[nodiscard]] MetalRoughImages to_metal_rough(const SpecGloss& factors, const Image* diffuse,
                                              const Image* specular_glossiness);

}  // namespace sheaf
