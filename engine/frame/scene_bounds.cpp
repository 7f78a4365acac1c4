// SPDX-License-Identifier: MIT
#include "frame/scene_bounds.hpp"

#include <algorithm>
#include <cmath>

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

struct MeshBounds {
  WorldBox all;                  // object space, with the mesh's centre
  std::vector<WorldBox> joints;  // of the vertices each joint moves
};

MeshBounds bounds_of(const Mesh& mesh) {
  MeshBounds bounds;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 p = glm::dvec3(mesh.positions[v]) + mesh.centre;
    add(bounds.all, p);
    if (mesh.joints.empty()) continue;
    for (std::size_t k = 0; k < 8; ++k) {
      if (mesh.weights[v][k] < 0.05F) continue;
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

void add_pose(WorldBox& box, const Scene& scene, const Pose& pose, const std::vector<MeshBounds>& meshes) {
  for (const auto index : scene.order) {
    const Node& node = scene.nodes[index];
    for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (node.skin != none && !mesh.joints.empty()) {
        const Skin& skin = scene.skins[node.skin];
        for (std::size_t j = 0; j < meshes[m].joints.size() && j < skin.joints.size(); ++j)
          if (!meshes[m].joints[j].empty())
            add_transformed(box, widened(meshes[m].joints[j], mesh, pose.morph_weights[index]),
                            pose.world[skin.joints[j]] * skin.inverse_bind[j]);
        continue;
      }
      const WorldBox local = widened(meshes[m].all, mesh, pose.morph_weights[index]);
      if (node.instances.empty()) add_transformed(box, local, pose.world[index]);
      for (const auto& instance : node.instances) add_transformed(box, local, pose.world[index] * instance);
    }
  }
}

}  // namespace

WorldBox animated_bounds(const Scene& scene, const std::vector<std::uint32_t>& animations) {
  constexpr int moments = 16;
  std::vector<MeshBounds> meshes;
  meshes.reserve(scene.meshes.size());
  for (const auto& mesh : scene.meshes) meshes.push_back(bounds_of(mesh));
  double duration = 0;
  for (const auto a : animations) duration = std::max(duration, scene.animations[a].duration);
  WorldBox box;
  for (int i = 0; i <= (duration > 0 ? moments : 0); ++i)
    add_pose(box, scene, evaluate_pose(scene, animations, duration * i / moments), meshes);
  return box;
}

}  // namespace sheaf
