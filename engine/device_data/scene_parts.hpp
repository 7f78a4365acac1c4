// SPDX-License-Identifier: MIT
// What the top level of the object hierarchy is built over. Were it whole instances, a ray would enter all of those
// that overlap, as the meshes of a building do that are its materials. So subtrees that overlap other instances are
// opened, the largest first, until there are enough parts (Benthin, Woop, Wald, Áfra, "Improved Two-Level BVHs using
// Partial Re-Braiding", HPG 2017; they open while they build, here it is done once before).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "hierarchy/object_hierarchy.hpp"

namespace sheaf {

struct ScenePart {
  std::uint32_t instance = 0;
  std::uint32_t child = 0;  // a node or a leaf, as nodes name their children
  Box box;                  // object space, rest pose
};

struct PartedInstance {
  const ObjectHierarchy* tree = nullptr;
  Box box;
  glm::dmat4 to_world{1};  // at rest
  bool whole = false;      // never opened: only the device knows where its vertices are
};

struct SceneParts {
  std::vector<ScenePart> parts;                   // by instance; children numbered as in its tree
  std::vector<std::vector<std::uint32_t>> above;  // an instance: nodes of its tree that are in no part
  double area = 0;                                // half the surface of the top level's nodes, less that of those above
};

/// At most `most` parts, but one an instance at least.
[[nodiscard]] SceneParts open_parts(std::span<const PartedInstance> instances, std::size_t most);

/// Of whole instances and of some numbers of parts up to `most`, those whose nodes, the top level's and their own, have
/// the least surface: as many a ray enters. Where instances hardly overlap, parts only tear their trees.
[[nodiscard]] SceneParts choose_parts(std::span<const PartedInstance> instances, std::size_t most);

/// Of a box's corners.
[[nodiscard]] Box transformed(const Box& box, const glm::dmat4& m);

}  // namespace sheaf
