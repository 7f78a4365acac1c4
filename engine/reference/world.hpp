// SPDX-License-Identifier: MIT
// The scene under a pose, in world space relative to the frame origin: skinned and morphed in double precision.
#pragma once

#include <vector>

#include "reference/reference.hpp"

namespace sheaf::reference {

struct WorldInstance {  // one mesh of one instance of one node
  std::uint32_t node, mesh, first_triangle;
  double side = 1;                                       // sign of the matrix' determinant; 1 where skinned
  std::vector<glm::dvec3> positions, normals, tangents;  // a vertex; tangents empty where the mesh has none
  std::vector<glm::vec2> uv0, uv1;                       // where they are morphed: in place of the mesh's own
  std::vector<glm::vec4> colors;
  std::vector<double> determinants;  // of the vertices' matrices, where a joint mirrors
  SurfaceRank rank;                  // among what lies in the same place

  /// The sign that turns (v1 − v0) × (v2 − v0) to the front.
  [[nodiscard]] double side_of(const glm::uvec3& v) const {
    return !determinants.empty() && determinants[v.x] + determinants[v.y] + determinants[v.z] < 0 ? -side : side;
  }
};

struct World {
  glm::dvec3 origin{0};
  double rank_extent = 0;  // Coincidence::extent
  std::vector<WorldInstance> instances;
  std::vector<ReferenceTriangle> triangles;
};

[[nodiscard]] World build_world(const Scene& scene, const Pose& pose, const glm::dvec3& origin,
                                const Coincidence& coincidence);

}  // namespace sheaf::reference
