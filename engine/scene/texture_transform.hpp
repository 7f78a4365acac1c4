// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "scene/scene.hpp"

namespace sheaf {

/// KHR_texture_transform: translation × rotation × scale, the rotation counter-clockwise with v pointing down.
[[nodiscard]] inline glm::vec2 transformed_uv(const TextureUse& use, const glm::vec2& uv) {
  const float c = std::cos(use.rotation), s = std::sin(use.rotation);
  const glm::vec2 scaled = uv * use.scale;
  return {c * scaled.x + s * scaled.y + use.offset.x, -s * scaled.x + c * scaled.y + use.offset.y};
}

}  // namespace sheaf
