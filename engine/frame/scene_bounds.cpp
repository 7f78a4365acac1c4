// SPDX-License-Identifier: MIT
#include "frame/scene_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sheaf {
namespace {

void add(WorldBox& box, const glm::dvec3& p) {
  box.lo = glm::min(box.lo, p);
  box.hi = glm::max(box.hi, p);
}

void add_transformed(WorldBox& box, const WorldBox& local, const glm::dmat4& m) {
  if (local.empty()) return;
  for (int c = 0; c < 8; ++c)
    add(box, glm::dvec3(m * glm::dvec4(c & 1 ? local.hi.x : local.lo.x, c & 2 ? local.hi.y : local.lo.y,
                                       c & 4 ? local.hi.z : local.lo.z, 1)));
}

// What a mesh is bounded by: its vertices one by one, or, where that would take too long, boxes of what each joint
// moves.
struct MeshBounds {
  bool exact = true;
  WorldBox all;                  // object space, with the mesh's centre
  std::vector<WorldBox> joints;  // of the vertices each joint moves
};

MeshBounds bounds_of(const Mesh& mesh, bool exact) {
  MeshBounds bounds;
  bounds.exact = exact;
  if (exact) return bounds;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 p = glm::dvec3(mesh.positions[v]) + mesh.centre;
    add(bounds.all, p);
    if (mesh.joints.empty()) continue;
    for (std::size_t k = 0; k < 8; ++k) {
      if (mesh.weights[v][k] == 0) continue;
      const std::size_t joint = mesh.joints[v][k];
      if (bounds.joints.size() <= joint) bounds.joints.resize(joint + 1);
      add(bounds.joints[joint], p);
    }
  }
  return bounds;
}

WorldBox widened(WorldBox box, const Mesh& mesh, const std::vector<double>& weights) {
  for (std::size_t t = 0; t < mesh.targets.size() && t < weights.size(); ++t) {
    WorldBox deltas;
    for (const auto& d : mesh.targets[t].positions) add(deltas, glm::dvec3(d) * weights[t]);
    if (deltas.empty()) continue;
    box.lo += glm::min(deltas.lo, glm::dvec3(0));
    box.hi += glm::max(deltas.hi, glm::dvec3(0));
  }
  return box;
}

glm::dvec3 morphed(const Mesh& mesh, std::size_t v, const std::vector<double>& weights) {
  glm::dvec3 p = glm::dvec3(mesh.positions[v]) + mesh.centre;
  for (std::size_t t = 0; t < mesh.targets.size() && t < weights.size(); ++t)
    if (!mesh.targets[t].positions.empty() && weights[t] != 0)
      p += weights[t] * glm::dvec3(mesh.targets[t].positions[v]);
  return p;
}

void add_skinned(WorldBox& box, const Scene& scene, const Pose& pose, const Node& node, const Mesh& mesh,
                 const MeshBounds& bounds, const std::vector<double>& weights) {
  const Skin& skin = scene.skins[node.skin];
  std::vector<glm::dmat4> joints;
  for (std::size_t j = 0; j < skin.joints.size(); ++j)
    joints.push_back(pose.world[skin.joints[j]] * skin.inverse_bind[j]);
  if (!bounds.exact) {
    for (std::size_t j = 0; j < bounds.joints.size() && j < joints.size(); ++j)
      if (!bounds.joints[j].empty()) add_transformed(box, widened(bounds.joints[j], mesh, weights), joints[j]);
    return;
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec4 p(morphed(mesh, v, weights), 1);
    glm::dvec3 sum(0);
    for (std::size_t k = 0; k < 8; ++k)
      if (mesh.weights[v][k] != 0)
        sum += static_cast<double>(mesh.weights[v][k]) * glm::dvec3(joints[mesh.joints[v][k]] * p);
    add(box, sum);
  }
}

void add_node(WorldBox& box, const Scene& scene, const Pose& pose, std::uint32_t index,
              const std::vector<MeshBounds>& meshes) {
  static const std::vector<glm::dmat4> once{glm::dmat4(1)};
  const Node& node = scene.nodes[index];
  const std::vector<double>& weights = pose.morph_weights[index];
  for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (node.skin != none && !mesh.joints.empty()) {
      add_skinned(box, scene, pose, node, mesh, meshes[m], weights);
      continue;
    }
    const WorldBox local = meshes[m].exact ? WorldBox{} : widened(meshes[m].all, mesh, weights);
    for (const auto& instance : node.instances.empty() ? once : node.instances) {
      const glm::dmat4 matrix = pose.world[index] * instance;
      add_transformed(box, local, matrix);
      if (!meshes[m].exact) continue;
      for (std::size_t v = 0; v < mesh.positions.size(); ++v)
        add(box, glm::dvec3(matrix * glm::dvec4(morphed(mesh, v, weights), 1)));
    }
  }
}

// Whether the node's picture can change: its place, its shape or its skin's joints.
std::vector<bool> changing_nodes(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  const auto moving = moving_nodes(scene, animations);
  auto changing = morphing_nodes(scene, animations);
  for (const auto index : scene.order) {
    changing[index] = changing[index] || moving[index];
    if (scene.nodes[index].skin == none) continue;
    for (const auto joint : scene.skins[scene.nodes[index].skin].joints)
      changing[index] = changing[index] || moving[joint];
  }
  return changing;
}

// Evenly spaced, and the first keys of the animations, where motions turn round.
std::vector<double> moments_of(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  constexpr int even = 32;
  constexpr std::size_t most_keys = 64;
  double duration = 0;
  std::vector<double> keys;
  for (const auto a : animations) {
    duration = std::max(duration, scene.animations[a].duration);
    for (const auto& channel : scene.animations[a].channels)
      for (std::size_t k = 0; k < std::min(most_keys, channel.times.size()); ++k) keys.push_back(channel.times[k]);
  }
  if (!(duration > 0)) return {0};
  std::ranges::sort(keys);
  keys.erase(std::ranges::unique(keys).begin(), keys.end());
  keys.resize(std::min(keys.size(), most_keys));
  for (int i = 0; i <= even; ++i) keys.push_back(duration * i / even);
  return keys;
}

// The meshes that are bounded vertex by vertex: those that take least, up to some tenths of a second in all.
std::vector<MeshBounds> bound_meshes(const Scene& scene, const std::vector<bool>& changing, std::size_t moments) {
  constexpr double most = 1 << 24;  // vertices that are placed
  std::vector<double> work(scene.meshes.size(), 0);
  for (const auto index : scene.order) {
    const Node& node = scene.nodes[index];
    for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m)
      work[m] += static_cast<double>(scene.meshes[m].positions.size()) *
                 static_cast<double>(std::max<std::size_t>(node.instances.size(), 1)) *
                 static_cast<double>(changing[index] ? moments : 1) *
                 static_cast<double>(1 + scene.meshes[m].targets.size() + (node.skin != none ? 4 : 0));
  }
  std::vector<std::size_t> least_first(work.size());
  std::iota(least_first.begin(), least_first.end(), std::size_t{0});
  std::ranges::stable_sort(least_first, {}, [&](std::size_t m) { return work[m]; });
  std::vector<MeshBounds> bounds(work.size());
  double sum = 0;
  for (const std::size_t m : least_first) {
    sum += work[m];
    bounds[m] = bounds_of(scene.meshes[m], sum <= most);
  }
  return bounds;
}

}  // namespace

WorldBox animated_bounds(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  const std::vector<double> moments = moments_of(scene, animations);
  const std::vector<bool> changing = changing_nodes(scene, animations);
  const std::vector<MeshBounds> meshes = bound_meshes(scene, changing, moments.size());
  WorldBox box;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const Pose pose = evaluate_pose(scene, animations, moments[i]);
    for (const auto index : scene.order)
      if (i == 0 || changing[index]) add_node(box, scene, pose, index, meshes);
  }
  return box;
}

}  // namespace sheaf
