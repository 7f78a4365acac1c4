// SPDX-License-Identifier: MIT
// Surfaces that lie in one place: in one plane, one upon the other. Which of them a ray meets first is not for rounding
// to decide, so they get ranks, by what they are and not by where they stand in the file (SHADING.md, Coincident
// surfaces).
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

inline constexpr std::uint32_t last_rank = 7;

struct SurfaceRank {
  std::uint32_t rank = 0;  // 0: alone in its place
  bool turns = false;      // a volume: from behind, where it ends, its rank is last_rank + 1 - rank
  [[nodiscard]] std::uint32_t seen(bool front) const { return turns && !front ? last_rank + 1 - rank : rank; }
};

struct Coincidence {
  double extent = 0;                              // the largest coordinate difference within a surface that has a rank
  std::vector<std::vector<SurfaceRank>> by_node;  // a node: copies times meshes; empty where all are 0
  [[nodiscard]] bool any() const { return extent > 0; }
  [[nodiscard]] SurfaceRank of(const Scene& scene, std::uint32_t node, std::uint32_t mesh, std::size_t copy) const;
};

struct SurfaceView {  // how rays see surfaces
  bool opaque = false, show_backs = false;
};

/// Of the scene at rest. Surfaces are a mesh's at a node; what lies within one of them is one surface. Scenes of more
/// than four million triangles are not searched.
[[nodiscard]] Coincidence find_coincident(const Scene& scene, const SurfaceView& view);

}  // namespace sheaf
