// SPDX-License-Identifier: MIT
#include "reference/world.hpp"

#include <algorithm>
#include <string>

#include "core/error.hpp"
#include "hierarchy/object_hierarchy.hpp"

namespace sheaf::reference {
namespace {

/// The matrix with its target moved so that `origin` becomes 0.
glm::dmat4 relative_to(const glm::dvec3& origin, glm::dmat4 matrix) {
  matrix[3] -= glm::dvec4(origin * matrix[3].w, 0);
  return matrix;
}

/// Inverse transpose of the linear part up to a positive factor, by cofactors so that a flattened mesh keeps the
/// normals that are still defined.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

template <int n>
glm::vec<n, double> morphed(const glm::vec<n, float>& rest, std::size_t vertex, const Mesh& mesh,
                            const std::vector<double>& weights,
                            std::vector<glm::vec<n, float>> MorphTarget::*attribute) {
  glm::vec<n, double> value(rest);
  for (std::size_t t = 0; t < mesh.targets.size() && t < weights.size(); ++t) {
    const auto& deltas = mesh.targets[t].*attribute;
    if (!deltas.empty()) value += weights[t] * glm::vec<n, double>(deltas[vertex]);
  }
  return value;
}

/// Σ w·J over the vertex' joints. Divided by Σ w in double: the file's floats sum to 1 only roughly, which far from the
/// origin would move the vertex.
glm::dmat4 blended(const Mesh& mesh, std::size_t vertex, const std::vector<glm::dmat4>& joints) {
  glm::dmat4 sum(0);
  double total = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const double w = mesh.weights[vertex][k];
    if (w == 0) continue;
    sum += w * joints[mesh.joints[vertex][k]];
    total += w;
  }
  return total > 0 ? sum / total : joints[mesh.joints[vertex][0]];
}

std::vector<glm::dmat4> joint_matrices(const Scene& scene, const Pose& pose, std::uint32_t skin,
                                       const glm::dvec3& origin) {
  std::vector<glm::dmat4> joints;
  for (std::size_t j = 0; j < scene.skins[skin].joints.size(); ++j) {
    joints.push_back(relative_to(origin, pose.world[scene.skins[skin].joints[j]]) * scene.skins[skin].inverse_bind[j]);
  }
  return joints;
}

/// Fills the vertices; `matrix_of(vertex)` gives each its way into the world.
template <class MatrixOf>
void place(WorldInstance& into, const Mesh& mesh, const std::vector<double>& weights, const MatrixOf& matrix_of) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dmat4& m = matrix_of(v);
    const glm::dvec3 p = mesh.centre + morphed(mesh.positions[v], v, mesh, weights, &MorphTarget::positions);
    into.positions.emplace_back(m * glm::dvec4(p, 1));
    const glm::dvec3 n = morphed(mesh.normals[v], v, mesh, weights, &MorphTarget::normals);
    into.normals.push_back(normal_matrix(glm::dmat3(m)) * n);
    if (mesh.tangents.empty()) continue;
    into.tangents.push_back(glm::dmat3(m) *
                            morphed(glm::vec3(mesh.tangents[v]), v, mesh, weights, &MorphTarget::tangents));
  }
}

/// Values of an attribute that some target changes; else nothing.
template <int n>
std::vector<glm::vec<n, float>> morphed_values(const Mesh& mesh, const std::vector<glm::vec<n, float>>& rest,
                                               const std::vector<double>& weights,
                                               std::vector<glm::vec<n, float>> MorphTarget::*attribute) {
  std::vector<glm::vec<n, float>> values;
  if (std::ranges::all_of(mesh.targets, [&](const MorphTarget& t) { return (t.*attribute).empty(); })) return values;
  for (std::size_t v = 0; v < rest.size(); ++v) values.emplace_back(morphed(rest[v], v, mesh, weights, attribute));
  return values;
}

void morph_attributes(WorldInstance& into, const Mesh& mesh, const std::vector<double>& weights) {
  into.uv0 = morphed_values(mesh, mesh.uv0, weights, &MorphTarget::uv0);
  into.uv1 = morphed_values(mesh, mesh.uv1, weights, &MorphTarget::uv1);
  into.colors = morphed_values(mesh, mesh.colors, weights, &MorphTarget::colors);
  for (glm::vec4& color : into.colors) color = glm::clamp(color, 0.0F, 1.0F);
}

/// Normals and tangents of a deformed mesh whose file has no normals: those of its deformed triangles.
void follow_faces(WorldInstance& into, const Mesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 v = mesh.triangles[t];
    const glm::dvec3 e1 = into.positions[v.y] - into.positions[v.x], e2 = into.positions[v.z] - into.positions[v.x];
    for (int c = 0; c < 3; ++c) {
      into.normals[v[c]] = glm::dvec3(0);  // the geometric normal stands in for none
      if (mesh.tangents.empty()) continue;
      const glm::dvec2 edges(mesh.face_tangents[t]);
      into.tangents[v[c]] = e1 * edges.x + e2 * edges.y;
    }
  }
}

void add_triangles(World& world, const Mesh& mesh) {
  const auto instance = static_cast<std::uint32_t>(world.instances.size() - 1);
  const WorldInstance& in = world.instances.back();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 v = mesh.triangles[t];
    world.triangles.push_back({{in.positions[v.x], in.positions[v.y], in.positions[v.z]}, instance, in.mesh, t});
  }
  if (world.triangles.size() > max_primitives) {
    throw limit_error("reference", "more than " + std::to_string(max_primitives) + " triangles after instancing");
  }
}

void add_node(World& world, const Scene& scene, const Pose& pose, std::uint32_t index, const Coincidence& coincidence) {
  const Node& node = scene.nodes[index];
  static const std::vector<glm::dmat4> once{glm::dmat4(1)};
  const auto& copies = node.instances.empty() ? once : node.instances;
  for (std::size_t copy = 0; copy < copies.size(); ++copy) {
    for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m) {
      const Mesh& mesh = scene.meshes[m];
      const auto first = static_cast<std::uint32_t>(world.triangles.size());
      WorldInstance& into = world.instances.emplace_back();
      into.node = index;
      into.mesh = m;
      into.first_triangle = first;
      into.rank = coincidence.of(scene, index, m, copy);
      if (node.skin != none && !mesh.joints.empty()) {
        const auto joints = joint_matrices(scene, pose, node.skin, world.origin);
        place(into, mesh, pose.morph_weights[index], [&](std::size_t v) { return blended(mesh, v, joints); });
        if (std::ranges::any_of(joints,
                                [](const glm::dmat4& joint) { return glm::determinant(glm::dmat3(joint)) < 0; }))
          for (std::size_t v = 0; v < mesh.positions.size(); ++v)
            into.determinants.push_back(glm::determinant(glm::dmat3(blended(mesh, v, joints))));
        if (mesh.flat) follow_faces(into, mesh);
      } else {
        const glm::dmat4 matrix = relative_to(world.origin, pose.world[index] * copies[copy]);
        into.side = glm::determinant(glm::dmat3(matrix)) < 0 ? -1 : 1;
        place(into, mesh, pose.morph_weights[index], [&](std::size_t) -> const glm::dmat4& { return matrix; });
        if (mesh.flat && !mesh.targets.empty()) follow_faces(into, mesh);
      }
      morph_attributes(into, mesh, pose.morph_weights[index]);
      add_triangles(world, mesh);
    }
  }
}

}  // namespace

World build_world(const Scene& scene, const Pose& pose, const glm::dvec3& origin, const Coincidence& coincidence) {
  World world;
  world.rank_extent = coincidence.extent;
  world.origin = origin;
  for (const std::uint32_t node : scene.order) add_node(world, scene, pose, node, coincidence);
  return world;
}

}  // namespace sheaf::reference

namespace sheaf {

std::vector<ReferenceTriangle> reference_triangles(const Scene& scene, const Pose& pose, const glm::dvec3& origin) {
  return reference::build_world(scene, pose, origin, {}).triangles;
}

}  // namespace sheaf
