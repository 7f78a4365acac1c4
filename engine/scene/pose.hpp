// SPDX-License-Identifier: MIT
// The scene at one moment: node transforms and morph weights, evaluated in double precision on the CPU.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

struct Pose {
  std::vector<glm::dmat4> world;  // a node: local to world; identity for nodes in neither Scene::order nor outside
  std::vector<std::vector<double>> morph_weights;  // a node
};

/// Which animations play: "all" (every one, later ones override earlier ones on the same target), an index, a name,
/// or empty: the first one, if any. Throws Error{input} for a name or index the scene does not have.
[[nodiscard]] std::vector<std::uint32_t> select_animations(const Scene& scene, const std::string& selector);

/// Time is clamped to each channel's keys (glTF 2.0, 3.11). STEP, LINEAR (shortest-arc slerp for rotations,
/// normalised) and CUBICSPLINE. Quaternions of zero length become identity.
[[nodiscard]] Pose evaluate_pose(const Scene& scene, const std::vector<std::uint32_t>& animations, double time_s);

/// True for each node whose world matrix can change under these animations (itself or an ancestor animated).
[[nodiscard]] std::vector<bool> moving_nodes(const Scene& scene, const std::vector<std::uint32_t>& animations);

/// Whether a joint of the skin may mirror what it carries, at rest or under any animation: a scale or a matrix whose
/// determinant is negative on the way from the root, or its inverse bind matrix.
[[nodiscard]] bool may_mirror(const Scene& scene, const Skin& skin);

/// True for each node whose morph weights are animated.
[[nodiscard]] std::vector<bool> morphing_nodes(const Scene& scene, const std::vector<std::uint32_t>& animations);

}  // namespace sheaf
