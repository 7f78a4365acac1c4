// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/pose.hpp"
#include "scene/scene.hpp"

namespace sheaf {

struct WorldBox {
  glm::dvec3 lo{1e300}, hi{-1e300};
  [[nodiscard]] bool empty() const { return lo.x > hi.x; }
};

/// Holds everything the animations show, looked at at 33 evenly spaced moments and at their first keys: a function of
/// scene and animations, not of the frames asked for. Meshes that would take long are bounded by boxes, joint by joint,
/// which may be too large; all others vertex by vertex.
[[nodiscard]] WorldBox animated_bounds(const Scene& scene, const std::vector<std::uint32_t>& animations);

}  // namespace sheaf
