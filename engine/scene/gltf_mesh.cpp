// SPDX-License-Identifier: MIT
#include "scene/gltf_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <set>

#include "scene/mesh_attributes.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t attribute_limit = 8;  // joints a vertex

struct Reader {
  GltfFile& file;
  const Accessors& accessors;
  const tinygltf::Primitive& primitive;
  std::string place;
  std::size_t vertices = 0;
  bool skinned = false;  // a node gives the mesh a skin

  [[nodiscard]] int accessor(const char* attribute) const {
    const auto found = primitive.attributes.find(attribute);
    return found == primitive.attributes.end() ? -1 : found->second;
  }
};

template <class V>
std::vector<V> as_vectors(const std::vector<float>& values) {
  static_assert(std::is_trivially_copyable_v<V>);
  std::vector<V> out(values.size() * sizeof(float) / sizeof(V));
  if (!out.empty()) std::memcpy(out.data(), values.data(), out.size() * sizeof(V));
  return out;
}

// An attribute's values, or nothing where the primitive has none. Every attribute has as many elements as POSITION.
template <class V>
std::vector<V> attribute(const Reader& in, const char* name, Components allowed) {
  const int accessor = in.accessor(name);
  if (accessor < 0) return {};
  if (in.accessors.count(accessor) != in.vertices) {
    in.file.fail(in.place, std::string(name) + " has " + std::to_string(in.accessors.count(accessor)) +
                               " elements, POSITION " + std::to_string(in.vertices));
  }
  return as_vectors<V>(in.accessors.floats(accessor, sizeof(V) / sizeof(float), allowed, name));
}

std::vector<glm::vec4> read_colors(const Reader& in) {
  const int accessor = in.accessor("COLOR_0");
  if (accessor < 0 || in.accessors.width(accessor) == 4) {
    return attribute<glm::vec4>(in, "COLOR_0", Components::floats_normalized);
  }
  std::vector<glm::vec4> colors;
  for (const glm::vec3& c : attribute<glm::vec3>(in, "COLOR_0", Components::floats_normalized)) {
    colors.emplace_back(c, 1.0f);
  }
  return colors;
}

void read_influence_set(const Reader& in, Mesh& mesh, std::size_t set) {
  const std::string joints_name = "JOINTS_" + std::to_string(set), weights_name = "WEIGHTS_" + std::to_string(set);
  const int joints_at = in.accessor(joints_name.c_str()), weights_at = in.accessor(weights_name.c_str());
  if (joints_at < 0 && weights_at < 0) return;
  if (joints_at < 0 || weights_at < 0)
    in.file.fail(in.place, joints_name + " and " + weights_name + " must come together");
  if (in.accessors.count(joints_at) != in.vertices)
    in.file.fail(in.place, joints_name + " has not as many elements as POSITION");
  const auto joints = in.accessors.integers(joints_at, 4, false, joints_name);
  const auto weights = attribute<glm::vec4>(in, weights_name.c_str(), Components::floats_normalized);
  mesh.joints.resize(in.vertices);
  mesh.weights.resize(in.vertices);
  bool negative = false;
  for (std::size_t v = 0; v < in.vertices; ++v) {
    for (std::size_t c = 0; c < 4; ++c) {
      const float weight = weights[v][static_cast<int>(c)];
      negative = negative || weight < 0;
      if (!(weight > 0)) continue;  // the joint of a weight of zero means nothing: left 0
      mesh.joints[v][set * 4 + c] = static_cast<std::uint16_t>(joints[v * 4 + c]);
      mesh.weights[v][set * 4 + c] = weight;
    }
  }
  if (negative) in.file.warn(in.place, weights_name + " has negative weights, taken as 0");
}

void normalize_weights(const Reader& in, Mesh& mesh) {
  bool weightless = false;
  for (auto& weights : mesh.weights) {
    double sum = 0;
    for (const float w : weights) sum += w;
    if (sum > 0) {
      for (float& w : weights) w = static_cast<float>(w / sum);
    } else {
      weights[0] = 1;  // joints[v][0] is 0 then: the skin's first joint
      weightless = true;
    }
  }
  if (weightless) in.file.warn(in.place, "vertices without any weight follow the skin's first joint");
}

void read_skinning(const Reader& in, Mesh& mesh) {
  for (std::size_t set = 0; set * 4 < attribute_limit; ++set) read_influence_set(in, mesh, set);
  if (in.accessor("JOINTS_0") < 0 && !mesh.joints.empty()) in.file.fail(in.place, "JOINTS_1 without JOINTS_0");
  if (in.accessor("JOINTS_2") >= 0) in.file.warn(in.place, "more than 8 joints a vertex, JOINTS_2 and on are ignored");
  normalize_weights(in, mesh);
}

// The deltas of one attribute of a target; nothing where it has none, or none that is not 0.
template <class V>
std::vector<V> deltas(const Reader& in, const std::map<std::string, int>& target, const std::string& place,
                      const char* name) {
  const auto found = target.find(name);
  if (found == target.end()) return {};
  if (in.accessors.count(found->second) != in.vertices)
    in.file.fail(place, std::string(name) + " has not as many elements as the primitive's POSITION");
  std::vector<V> values;
  bool read = false;
  if constexpr (std::is_same_v<V, glm::vec4>) {
    read = in.accessors.width(found->second) == 3;  // alpha's deltas are 0
    if (read)
      for (const glm::vec3& rgb : deltas<glm::vec3>(in, target, place, name)) values.emplace_back(rgb, 0.0f);
  }
  if (!read)
    values = as_vectors<V>(
        in.accessors.floats(found->second, sizeof(V) / sizeof(float), Components::floats_quantized, name));
  if (std::ranges::all_of(values, [](const V& v) { return v == V(0); })) values.clear();
  return values;
}

// What a target's attribute has no use for: a warning for each primitive, since models have dozens of targets.
void warn_of_unread(const Reader& in) {
  static constexpr std::array read{"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  std::set<std::string> told;
  for (std::size_t t = 0; t < in.primitive.targets.size(); ++t) {
    for (const auto& [name, accessor] : in.primitive.targets[t]) {
      const bool known = std::ranges::find(read, name) != read.end();
      if (name.starts_with('_') || name == "NORMAL" || name == "TANGENT" || !told.insert(name).second) continue;
      const std::string place = in.place + "." + at("targets", t) + "." + name.substr(0, 40);
      if (!known) {
        told.insert(name);
        in.file.warn(place, "is ignored: POSITION, NORMAL, TANGENT, TEXCOORD_0, TEXCOORD_1 and COLOR_0 are morphed");
      } else if (in.accessor(name.c_str()) < 0) {
        in.file.warn(place, "is ignored: the primitive has no " + name + " for it to change");
      }
    }
  }
}

void read_targets(const Reader& in, Mesh& mesh) {
  for (std::size_t t = 0; t < in.primitive.targets.size(); ++t) {
    const auto& source = in.primitive.targets[t];
    const std::string place = in.place + ".targets[" + std::to_string(t) + "]";
    MorphTarget target;
    target.positions = deltas<glm::vec3>(in, source, place, "POSITION");
    target.normals = deltas<glm::vec3>(in, source, place, "NORMAL");
    target.tangents = deltas<glm::vec3>(in, source, place, "TANGENT");
    if (!mesh.uv0.empty()) target.uv0 = deltas<glm::vec2>(in, source, place, "TEXCOORD_0");
    if (!mesh.uv1.empty()) target.uv1 = deltas<glm::vec2>(in, source, place, "TEXCOORD_1");
    if (!mesh.colors.empty()) target.colors = deltas<glm::vec4>(in, source, place, "COLOR_0");
    mesh.targets.push_back(std::move(target));
  }
  warn_of_unread(in);
}

std::vector<std::uint32_t> read_indices(const Reader& in) {
  std::vector<std::uint32_t> indices;
  if (in.primitive.indices < 0) {
    indices.resize(in.vertices);
    for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
    return indices;
  }
  indices = in.accessors.integers(in.primitive.indices, 1, true, "indices");
  for (const std::uint32_t index : indices) {
    if (index >= in.vertices) {
      in.file.fail(in.place,
                   "index " + std::to_string(index) + " is outside its " + std::to_string(in.vertices) + " vertices");
    }
  }
  return indices;
}

// Strips and fans as glTF 2.0, 3.7.2.1 numbers their triangles, so that all face the same way.
void assemble_triangles(const Reader& in, Mesh& mesh) {
  const std::vector<std::uint32_t> i = read_indices(in);
  const bool list = in.primitive.mode == TINYGLTF_MODE_TRIANGLES;
  const std::size_t count = list ? i.size() / 3 : i.size() < 3 ? 0 : i.size() - 2;
  if (list && i.size() % 3 != 0)
    in.file.warn(in.place, "the number of indices is not a multiple of 3, the rest is ignored");
  mesh.triangles.reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    if (list) {
      mesh.triangles.emplace_back(i[3 * t], i[3 * t + 1], i[3 * t + 2]);
    } else if (in.primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      mesh.triangles.emplace_back(i[t], i[t + 1 + t % 2], i[t + 2 - t % 2]);
    } else {
      mesh.triangles.emplace_back(i[t + 1], i[t + 2], i[0]);
    }
  }
}

void read_vertices(const Reader& in, Mesh& mesh, const Material& material) {
  mesh.positions = attribute<glm::vec3>(in, "POSITION", Components::floats_quantized);
  mesh.normals = attribute<glm::vec3>(in, "NORMAL", Components::floats_quantized);
  if (material.normal_texture.present())
    mesh.tangents = attribute<glm::vec4>(in, "TANGENT", Components::floats_quantized);
  mesh.uv0 = attribute<glm::vec2>(in, "TEXCOORD_0", Components::floats_quantized);
  mesh.uv1 = attribute<glm::vec2>(in, "TEXCOORD_1", Components::floats_quantized);
  mesh.colors = read_colors(in);
  if (in.skinned) read_skinning(in, mesh);
  read_targets(in, mesh);
}

void complete_attributes(Mesh& mesh, const Material& material) {
  if (mesh.normals.empty()) {
    make_flat_normals(mesh);
  } else {
    normalize_normals(mesh);
  }
  if (material.normal_texture.present() && mesh.tangents.empty()) make_tangents(mesh, material.normal_texture);
  for (glm::vec4& t : mesh.tangents) {
    const float length = glm::length(glm::vec3(t));
    t = glm::vec4(length > 0 ? glm::vec3(t) / length : glm::vec3(1, 0, 0), t.w < 0 ? -1.0f : 1.0f);
  }
}

// Positions become offsets from the box's centre. The centre is rounded to float, so that for meshes no larger than
// their distance from the origin the difference is exact.
void centre_positions(Mesh& mesh) {
  glm::dvec3 lo(mesh.positions.front()), hi = lo;
  for (const glm::vec3& p : mesh.positions) {
    lo = glm::min(lo, glm::dvec3(p));
    hi = glm::max(hi, glm::dvec3(p));
  }
  mesh.centre = glm::dvec3(glm::vec3((lo + hi) * 0.5));
  for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) - mesh.centre);
}

const char* mode_name(int mode) {
  switch (mode) {
    case TINYGLTF_MODE_POINTS:
      return "points";
    case TINYGLTF_MODE_LINE:
      return "lines";
    case TINYGLTF_MODE_LINE_LOOP:
      return "a line loop";
    default:
      return "a line strip";
  }
}

// Nothing where the primitive has no surface.
std::optional<Mesh> read_primitive(const Reader& in, const std::string& mesh_name, std::uint32_t material,
                                   const Scene& scene) {
  if (in.primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    in.file.warn(in.place, std::string("is ") + mode_name(in.primitive.mode) + ", which are not drawn");
    return std::nullopt;
  }
  if (in.vertices == 0) {
    in.file.warn(in.place, "has no POSITION and is not drawn");
    return std::nullopt;
  }
  Mesh mesh;
  mesh.name = in.place + (mesh_name.empty() ? "" : " (" + mesh_name + ")");
  mesh.material = material;
  assemble_triangles(in, mesh);
  if (mesh.triangles.empty()) {
    in.file.warn(in.place, "has no triangle");
    return std::nullopt;
  }
  read_vertices(in, mesh, scene.materials[material]);
  complete_attributes(mesh, scene.materials[material]);
  centre_positions(mesh);
  return mesh;
}

void finish_entry(GltfFile& file, std::size_t m, const Scene& scene, MeshEntry& entry) {
  const tinygltf::Mesh& source = file.model.meshes[m];
  const std::string place = at("meshes", m);
  entry.count = static_cast<std::uint32_t>(scene.meshes.size()) - entry.first;
  for (std::size_t p = 0; p < source.primitives.size(); ++p) {
    if (source.primitives[p].targets.size() != source.primitives[0].targets.size()) {
      file.fail(place + "." + at("primitives", p), "has another number of morph targets than the first primitive");
    }
  }
  entry.targets = source.primitives.empty() ? 0 : static_cast<std::uint32_t>(source.primitives[0].targets.size());
  if (!source.weights.empty() && source.weights.size() != entry.targets) {
    file.fail(place + ".weights", "has " + std::to_string(source.weights.size()) + " weights for " +
                                      std::to_string(entry.targets) + " morph targets");
  }
  entry.weights = source.weights;
  entry.weights.resize(entry.targets, 0.0);

  std::uint32_t skinned = 0;
  for (std::uint32_t i = entry.first; i < entry.first + entry.count; ++i) {
    if (scene.meshes[i].joints.empty()) continue;
    ++skinned;
    for (const auto& joints : scene.meshes[i].joints) {
      entry.joints = std::max<std::uint32_t>(entry.joints, *std::ranges::max_element(joints) + 1u);
    }
  }
  if (skinned != 0 && skinned != entry.count) file.fail(place, "some primitives have JOINTS_0 and others have not");
}

std::vector<bool> meshes_with_skin(const GltfFile& file, const Scene& scene) {
  std::vector<bool> skinned(file.model.meshes.size(), false);
  for (const std::uint32_t index : scene.order) {
    const tinygltf::Node& node = file.model.nodes[index];
    if (node.mesh >= 0 && node.skin >= 0) skinned[static_cast<std::size_t>(node.mesh)] = true;
  }
  return skinned;
}

}  // namespace

std::vector<MeshEntry> load_meshes(GltfFile& file, const std::vector<bool>& wanted, Scene& scene) {
  const Accessors accessors(file);
  const std::vector<bool> skinned = meshes_with_skin(file, scene);
  std::vector<MeshEntry> entries(file.model.meshes.size());
  std::uint64_t triangles = 0, vertices = 0;
  for (std::size_t m = 0; m < entries.size(); ++m) {
    entries[m].first = static_cast<std::uint32_t>(scene.meshes.size());
    if (!wanted[m]) continue;
    file.require("meshes", m);
    const tinygltf::Mesh& source = file.model.meshes[m];
    for (std::size_t p = 0; p < source.primitives.size(); ++p) {
      Reader in{file, accessors, source.primitives[p], at("meshes", m) + "." + at("primitives", p), 0, skinned[m]};
      if (const int position = in.accessor("POSITION"); position >= 0) in.vertices = accessors.count(position);
      const int index = in.primitive.material;
      // The default material stands after the file's own.
      const auto material =
          index < 0 ? static_cast<std::uint32_t>(scene.materials.size() - 1) : static_cast<std::uint32_t>(index);
      std::optional<Mesh> mesh = read_primitive(in, source.name, material, scene);
      if (!mesh) continue;
      triangles += mesh->triangles.size();
      vertices += mesh->positions.size();
      if (triangles > file.limits.triangles)
        file.over_limit(in.place, "the scene has more than " + std::to_string(file.limits.triangles) + " triangles");
      if (vertices > file.limits.vertices)
        file.over_limit(in.place, "the scene has more than " + std::to_string(file.limits.vertices) + " vertices");
      scene.meshes.push_back(std::move(*mesh));
    }
    finish_entry(file, m, scene, entries[m]);
  }
  return entries;
}

}  // namespace sheaf
