// SPDX-License-Identifier: MIT
// The scene's surfaces in the world, at rest.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

struct RestSurface {  // a mesh at a node
  std::uint32_t node = 0, mesh_index = 0;
  std::size_t copy = 0;
  const Mesh* mesh = nullptr;
  glm::dmat4 world{1};               // of a mesh that does not deform
  std::vector<glm::dvec3> deformed;  // else its vertices
  double side = 1;                   // -1: mirrored
  glm::dvec3 lo{0}, hi{0};           // bounds
  bool may_meet = false;             // whether its bounds overlap another's
  [[nodiscard]] glm::dvec3 position(std::uint32_t vertex) const {
    if (!deformed.empty()) return deformed[vertex];
    return glm::dvec3(world * glm::dvec4(mesh->centre + glm::dvec3(mesh->positions[vertex]), 1));
  }
};

[[nodiscard]] std::vector<RestSurface> rest_surfaces(const Scene& scene);

}  // namespace sheaf
