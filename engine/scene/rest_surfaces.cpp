// SPDX-License-Identifier: MIT
#include "scene/rest_surfaces.hpp"

#include <algorithm>
#include <limits>

#include "scene/pose.hpp"

namespace sheaf {
namespace {

std::vector<glm::dvec3> deformed(const Scene& scene, const Pose& pose, std::uint32_t index, const Mesh& mesh,
                                 const glm::dmat4& world) {
  const Node& node = scene.nodes[index];
  const std::vector<double>& weights = pose.morph_weights[index];
  const bool skinned = node.skin != none && !mesh.joints.empty();
  std::vector<glm::dmat4> joints;
  if (skinned)
    for (std::size_t j = 0; j < scene.skins[node.skin].joints.size(); ++j)
      joints.push_back(pose.world[scene.skins[node.skin].joints[j]] * scene.skins[node.skin].inverse_bind[j]);
  std::vector<glm::dvec3> positions;
  positions.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::dvec3 p = mesh.centre + glm::dvec3(mesh.positions[v]);
    for (std::size_t t = 0; t < mesh.targets.size() && t < weights.size(); ++t)
      if (!mesh.targets[t].positions.empty()) p += weights[t] * glm::dvec3(mesh.targets[t].positions[v]);
    glm::dmat4 matrix = world;
    if (skinned) {
      matrix = glm::dmat4(0);
      for (std::size_t k = 0; k < 8; ++k)
        if (mesh.weights[v][k] != 0) matrix += double{mesh.weights[v][k]} * joints[mesh.joints[v][k]];
    }
    positions.emplace_back(matrix * glm::dvec4(p, 1));
  }
  return positions;
}

// By a sweep along x: all but a few of the pairs end there.
void mark_meeting(std::vector<RestSurface>& surfaces) {
  constexpr std::size_t most_swept = 20'000;
  if (surfaces.size() > most_swept) {
    for (RestSurface& s : surfaces) s.may_meet = true;
    return;
  }
  std::vector<RestSurface*> order;
  for (RestSurface& s : surfaces) order.push_back(&s);
  std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) { return a->lo.x < b->lo.x; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const RestSurface& a = *order[i];
    for (std::size_t k = i + 1; k < order.size() && order[k]->lo.x <= a.hi.x; ++k) {
      const RestSurface& b = *order[k];
      if (a.may_meet && b.may_meet) continue;
      if (a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z && b.lo.z <= a.hi.z)
        order[i]->may_meet = order[k]->may_meet = true;
    }
  }
}

}  // namespace

std::vector<RestSurface> rest_surfaces(const Scene& scene) {
  const Pose pose = evaluate_pose(scene, {}, 0);
  std::vector<RestSurface> surfaces;
  for (const std::uint32_t index : scene.order) {
    const Node& node = scene.nodes[index];
    for (std::size_t copy = 0; copy < std::max<std::size_t>(node.instances.size(), 1); ++copy) {
      for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m) {
        const Mesh& mesh = scene.meshes[m];
        if (mesh.triangles.empty()) continue;
        RestSurface s;
        s.node = index;
        s.mesh_index = m;
        s.copy = copy;
        s.mesh = &mesh;
        s.world = pose.world[index] * (node.instances.empty() ? glm::dmat4(1) : node.instances[copy]);
        s.side = glm::determinant(glm::dmat3(s.world)) < 0 ? -1 : 1;
        if ((node.skin != none && !mesh.joints.empty()) || !mesh.targets.empty())
          s.deformed = deformed(scene, pose, index, mesh, s.world);
        s.lo = glm::dvec3(std::numeric_limits<double>::max());
        s.hi = -s.lo;
        for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
          const glm::dvec3 p = s.position(v);
          s.lo = glm::min(s.lo, p);
          s.hi = glm::max(s.hi, p);
        }
        surfaces.push_back(std::move(s));
      }
    }
  }
  mark_meeting(surfaces);
  return surfaces;
}

}  // namespace sheaf
