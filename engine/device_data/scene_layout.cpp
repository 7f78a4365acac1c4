// SPDX-License-Identifier: MIT
#include "device_data/scene_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "core/error.hpp"
#include "device_data/material_layout.hpp"
#include "hierarchy/slot_order.hpp"
#include "scene/pose.hpp"

namespace sheaf {
namespace {

struct MeshPlace {  // where a mesh lies in the shared buffers, made on first use
  bool placed = false, deforms = false;
  gpu::Instance place{};
  ObjectHierarchy hierarchy;
  std::uint32_t joint_words = none, morph_first = none, morph_normals = none, morph_tangents = none,
                morph_colors = none, morph_alphas = none, face_tangents = none;
  std::array<std::uint32_t, 2> morph_uvs{none, none};
};

Box triangle_box(const Mesh& mesh, const glm::uvec3& t) {
  const auto &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  return {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
}

template <typename T>
std::uint32_t append(std::vector<T>& to, const std::vector<T>& from) {
  if (from.empty()) return none;
  const auto first = static_cast<std::uint32_t>(to.size());
  to.insert(to.end(), from.begin(), from.end());
  return first;
}

std::uint32_t append_joints(SceneLayout& layout, const Mesh& mesh) {
  if (mesh.joints.empty()) return none;
  const auto first = static_cast<std::uint32_t>(layout.joints.size());
  for (std::size_t v = 0; v < mesh.joints.size(); ++v) {
    for (std::size_t k = 0; k < 8; k += 2)
      layout.joints.push_back(mesh.joints[v][k] | static_cast<std::uint32_t>(mesh.joints[v][k + 1]) << 16U);
    for (std::size_t k = 0; k < 8; ++k) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &mesh.weights[v][k], 4);
      layout.joints.push_back(bits);
    }
  }
  return first;
}

// Deltas of all targets, one block after the other; an attribute that some target lacks is filled with zeros.
// `word_of` makes a value of an attribute the three floats that are kept.
template <typename V, typename WordOf>
std::uint32_t append_targets(SceneLayout& layout, const Mesh& mesh, std::vector<V> MorphTarget::*attribute,
                             WordOf word_of) {
  const bool any =
      std::any_of(mesh.targets.begin(), mesh.targets.end(), [&](const auto& t) { return !(t.*attribute).empty(); });
  if (!any) return none;
  const auto first = static_cast<std::uint32_t>(layout.morphs.size());
  for (const auto& target : mesh.targets) {
    for (const V& value : target.*attribute) layout.morphs.push_back(word_of(value));
    layout.morphs.resize(layout.morphs.size() + mesh.positions.size() - (target.*attribute).size(), glm::vec3(0));
  }
  return first;
}

// Texture coordinates and colors that are morphed: the instance has a place of its own for them.
void place_morphed_attributes(SceneLayout& layout, const Mesh& mesh, const MeshPlace& place, gpu::Instance& instance,
                              gpu::Deform& d) {
  const std::array from{place.place.uv0, place.place.uv1};
  const std::array uvs{&mesh.uv0, &mesh.uv1};
  const std::array to{&instance.uv0, &instance.uv1};
  for (std::size_t set = 0; set < uvs.size(); ++set) {
    d.uv_from[set] = from[set];
    d.uv_morphs[set] = place.morph_uvs[set];
    if (d.uv_morphs[set] == none) continue;
    d.uv_to[set] = *to[set] = append(layout.uvs, *uvs[set]);
    layout.morphed_attributes = true;
  }
  d.color_from = place.place.color;
  d.color_morphs = place.morph_colors;
  d.alpha_morphs = place.morph_alphas;
  if (d.color_morphs == none && d.alpha_morphs == none) return;
  d.color_to = instance.color = append(layout.colors, mesh.colors);
  layout.morphed_attributes = true;
}

// What all instances of a deforming mesh share: its deltas, and how its faces' tangents run.
void place_targets(SceneLayout& layout, const Mesh& mesh, MeshPlace& place) {
  if (place.deforms) return;
  place.deforms = true;
  const auto same = [](const glm::vec3& v) { return v; };
  const auto of_uv = [](const glm::vec2& v) { return glm::vec3(v, 0); };
  place.morph_first = append_targets(layout, mesh, &MorphTarget::positions, same);
  place.morph_normals = append_targets(layout, mesh, &MorphTarget::normals, same);
  place.morph_tangents = append_targets(layout, mesh, &MorphTarget::tangents, same);
  place.morph_uvs = {append_targets(layout, mesh, &MorphTarget::uv0, of_uv),
                     append_targets(layout, mesh, &MorphTarget::uv1, of_uv)};
  place.morph_colors = append_targets(layout, mesh, &MorphTarget::colors, [](const auto& c) { return glm::vec3(c); });
  const bool fades = std::ranges::any_of(mesh.targets, [](const MorphTarget& t) {
    return std::ranges::any_of(t.colors, [](const glm::vec4& c) { return c.a != 0; });
  });
  if (fades)
    place.morph_alphas =
        append_targets(layout, mesh, &MorphTarget::colors, [](const auto& c) { return glm::vec3(c.a, 0, 0); });
  if (mesh.face_tangents.empty()) return;
  place.face_tangents = static_cast<std::uint32_t>(layout.morphs.size());
  for (const auto& edges : mesh.face_tangents) layout.morphs.emplace_back(edges, 0.0F);
  layout.face_tangents = true;
}

void place_mesh(SceneLayout& layout, const Mesh& mesh, MeshPlace& place) {
  place.placed = true;
  std::vector<Box> boxes;
  boxes.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) boxes.push_back(triangle_box(mesh, t));
  HierarchyOptions options;
  options.leaf_size = gpu::LEAF_TRIANGLES;
  place.hierarchy = build_object_hierarchy(boxes, options);
  for (auto& node : place.hierarchy.nodes) order_slots(node);
  auto& p = place.place;
  p.first_index = static_cast<std::uint32_t>(layout.indices.size());
  p.first_vertex = static_cast<std::uint32_t>(layout.positions.size());
  p.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (const auto t : place.hierarchy.order)
    for (int k = 0; k < 3; ++k) layout.indices.push_back(mesh.triangles[t][k]);
  layout.positions.insert(layout.positions.end(), mesh.positions.begin(), mesh.positions.end());
  layout.normals.insert(layout.normals.end(), mesh.normals.begin(), mesh.normals.end());
  p.uv0 = append(layout.uvs, mesh.uv0);
  p.uv1 = append(layout.uvs, mesh.uv1);
  p.color = append(layout.colors, mesh.colors);
  p.tangent = append(layout.tangents, mesh.tangents);
}

void place_deforming(SceneLayout& layout, const Scene& scene, const InstanceSource& source, gpu::Instance& instance,
                     MeshPlace& place) {
  const Mesh& mesh = scene.meshes[source.mesh];
  const Node& node = scene.nodes[source.node];
  const bool skinned = node.skin != none && !mesh.joints.empty();
  if (skinned && place.joint_words == none) place.joint_words = append_joints(layout, mesh);
  place_targets(layout, mesh, place);
  gpu::Deform d{};
  d.first_vertex = instance.first_vertex;
  d.vertex_count = static_cast<std::uint32_t>(mesh.positions.size());
  d.dynamic = instance.dynamic = layout.dynamic_vertices;
  d.joint_words = skinned ? place.joint_words : none;
  d.first_matrix = layout.skin_matrices;
  d.morph_first = place.morph_first;
  d.morph_normals = place.morph_normals;
  d.morph_tangents = place.morph_tangents;
  d.morph_targets = static_cast<std::uint32_t>(mesh.targets.size());
  d.weight_first = layout.morph_weights;
  d.tangent = instance.tangent;
  d.instance = static_cast<std::uint32_t>(layout.instances.size());
  d.flat_faces = mesh.flat ? 1 : 0;
  d.face_tangents = place.face_tangents;
  place_morphed_attributes(layout, mesh, place, instance, d);
  if (skinned && may_mirror(scene, scene.skins[node.skin])) {
    instance.marks = (instance.marks & ~gpu::INSTANCE_DEFORM) | static_cast<std::uint32_t>(layout.deforms.size());
    layout.mirrored_skins = true;
  }
  layout.dynamic_vertices += d.vertex_count;
  layout.skin_matrices += skinned ? static_cast<std::uint32_t>(scene.skins[node.skin].joints.size()) : 0;
  layout.morph_weights += d.morph_targets;
  layout.deforms.push_back(d);
}

// The mesh's tree once more, for one instance: references moved to its nodes and triangles.
// `parts` are the instance's, `above` its nodes that none of them holds.
void place_hierarchy(SceneLayout& layout, const ObjectHierarchy& tree, std::uint32_t first_triangle,
                     std::span<ScenePart> parts, std::span<const std::uint32_t> above) {
  const auto base = static_cast<std::uint32_t>(layout.node_children.size() / wide);
  const auto instance = static_cast<std::uint32_t>(layout.instances.size());
  const auto moved = [&](std::uint32_t child) {
    if (is_leaf(child)) return leaf_child(leaf_first(child) + first_triangle, leaf_count(child));
    return is_node(child) ? child + base : child;
  };
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    for (const auto child : tree.nodes[n].child) layout.node_children.push_back(moved(child));
    layout.node_instance.push_back(instance);
    if (std::binary_search(above.begin(), above.end(), n)) continue;
    const auto height = tree.height[n];
    if (layout.refit_by_height.size() <= height) layout.refit_by_height.resize(height + 1);
    layout.refit_by_height[height].push_back(base + n);
  }
  for (auto& part : parts) part.child = moved(part.child);
}

Box mesh_box(const Mesh& mesh) {
  Box box;
  for (const auto& p : mesh.positions) {
    box.lo = glm::min(box.lo, p);
    box.hi = glm::max(box.hi, p);
  }
  return box;
}

std::vector<InstanceSource> list_instances(const Scene& scene, const Coincidence& coincidence) {
  std::vector<InstanceSource> sources;
  for (const auto index : scene.order) {
    const Node& node = scene.nodes[index];
    const std::size_t copies = std::max<std::size_t>(node.instances.size(), 1);
    for (std::uint32_t m = node.first_mesh; m < node.first_mesh + node.mesh_count; ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (mesh.triangles.empty()) continue;
      for (std::size_t c = 0; c < copies; ++c) {
        InstanceSource source;
        source.node = index;
        source.mesh = m;
        source.rank = coincidence.of(scene, index, m, c);
        source.deforms = (node.skin != none && !mesh.joints.empty()) || !mesh.targets.empty();
        glm::dmat4 centre(1);
        centre[3] = glm::dvec4(mesh.centre, 1);
        source.within_node = (node.instances.empty() ? glm::dmat4(1) : node.instances[c]) * centre;
        sources.push_back(source);
      }
    }
  }
  return sources;
}

// The top level is built anew whenever something moves: two microseconds a part. More are no better: nodes that a
// shadow ray enters in Sponza's atrium, of whole instances and of 512, 1024, 2048, 4096, 8192, 16384 parts:
// 31; 15.0, 14.5, 15.1, 15.3, 14.7, 17.0.
constexpr std::size_t most_parts = std::size_t{1} << 10U;

// Of all instances; makes room for the top level. What is above an instance's parts is returned.
std::vector<std::vector<std::uint32_t>> place_parts(const Scene& scene, const std::vector<MeshPlace>& places,
                                                    SceneLayout& layout) {
  const Pose rest = evaluate_pose(scene, {}, 0);
  std::vector<PartedInstance> instances;
  instances.reserve(layout.sources.size());
  for (const auto& source : layout.sources)
    instances.push_back({&places[source.mesh].hierarchy, layout.mesh_boxes[source.mesh],
                         rest.world[source.node] * source.within_node, source.deforms});
  SceneParts chosen = choose_parts(instances, most_parts);
  layout.parts = std::move(chosen.parts);
  layout.top_nodes = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(layout.parts.size()));
  layout.node_children.assign(std::size_t{layout.top_nodes} * wide, empty_child);
  return std::move(chosen.above);
}

}  // namespace

SceneLayout lay_out(const Scene& scene, const RenderSettings& settings, const Coincidence& coincidence) {
  SceneLayout layout;
  layout.sources = list_instances(scene, coincidence);
  layout.rank_extent = coincidence.extent;
  if (layout.sources.size() > gpu::TRIANGLE_INSTANCE_MASK)
    throw limit_error(scene.path, "more than 2^24 meshes with all instances");
  const auto material_of = lay_out_materials(scene, settings, layout);
  std::vector<MeshPlace> places(scene.meshes.size());
  for (const auto& mesh : scene.meshes) layout.mesh_boxes.push_back(mesh_box(mesh));
  for (const auto& source : layout.sources)
    if (!places[source.mesh].placed) place_mesh(layout, scene.meshes[source.mesh], places[source.mesh]);
  const auto above = place_parts(scene, places, layout);
  auto part = layout.parts.begin();
  for (auto& source : layout.sources) {
    const Mesh& mesh = scene.meshes[source.mesh];
    MeshPlace& place = places[source.mesh];
    gpu::Instance instance = place.place;
    instance.first_triangle = static_cast<std::uint32_t>(layout.triangles);
    instance.dynamic = none;
    instance.material = material_of[mesh.material];
    instance.object = source.node + 1;
    instance.marks =
        gpu::INSTANCE_DEFORM | source.rank.rank << gpu::TRIANGLE_RANK | (source.rank.turns ? gpu::TRIANGLE_TURNS : 0);
    layout.triangles += instance.triangle_count;
    if (layout.triangles > max_primitives)
      throw limit_error(scene.path, "more than " + std::to_string(max_primitives) + " triangles with all instances");
    if (source.deforms) place_deforming(layout, scene, source, instance, place);
    const auto number = layout.instances.size();
    const auto end = std::find_if(part, layout.parts.end(), [&](const auto& p) { return p.instance != number; });
    place_hierarchy(layout, place.hierarchy, instance.first_triangle, {part, end}, above[number]);
    part = end;
    layout.instances.push_back(instance);
  }
  return layout;
}

}  // namespace sheaf
