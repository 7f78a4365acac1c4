// SPDX-License-Identifier: MIT
#include "scene/gltf_mesh.hpp"

#include <algorithm>
#include <optional>

#include "scene/gltf_deformation.hpp"
#include "scene/gltf_draco.hpp"
#include "scene/mesh_attributes.hpp"

namespace sheaf {
namespace {

std::vector<glm::vec4> read_colors(const PrimitiveReader& in) {
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

std::vector<std::uint32_t> read_indices(const PrimitiveReader& in) {
  std::vector<std::uint32_t> indices;
  if (in.primitive.indices < 0 && !in.decoded_indices) {
    indices.resize(in.vertices);
    for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
    return indices;
  }
  indices = in.decoded_indices ? *in.decoded_indices : in.accessors.integers(in.primitive.indices, 1, true, "indices");
  for (const std::uint32_t index : indices) {
    if (index >= in.vertices) {
      in.file.fail(in.place,
                   "index " + std::to_string(index) + " is outside its " + std::to_string(in.vertices) + " vertices");
    }
  }
  return indices;
}

// Strips and fans as glTF 2.0, 3.7.2.1 numbers their triangles, so that all face the same way.
void assemble_triangles(const PrimitiveReader& in, Mesh& mesh) {
  const std::vector<std::uint32_t> i = read_indices(in);
  const bool list = in.primitive.mode == TINYGLTF_MODE_TRIANGLES || in.decoded_indices;
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

void read_vertices(const PrimitiveReader& in, Mesh& mesh, const Material& material) {
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
std::optional<Mesh> read_primitive(const PrimitiveReader& in, const std::string& mesh_name, std::uint32_t material,
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
    if (node.mesh >= 0 && node.skin >= 0 && scene.nodes[index].shown)
      skinned[static_cast<std::size_t>(node.mesh)] = true;
  }
  return skinned;
}

}  // namespace

std::vector<MeshEntry> load_meshes(GltfFile& file, const std::vector<bool>& wanted, Scene& scene) {
  const std::vector<bool> skinned = meshes_with_skin(file, scene);
  std::vector<MeshEntry> entries(file.model.meshes.size());
  std::uint64_t triangles = 0, vertices = 0;
  for (std::size_t m = 0; m < entries.size(); ++m) {
    entries[m].first = static_cast<std::uint32_t>(scene.meshes.size());
    if (!wanted[m]) continue;
    file.require("meshes", m);
    const tinygltf::Mesh& source = file.model.meshes[m];
    for (std::size_t p = 0; p < source.primitives.size(); ++p) {
      const std::string place = at("meshes", m) + "." + at("primitives", p);
      const std::optional<DracoPrimitive> draco = read_draco(file, m, p, place);
      const Accessors accessors = draco ? Accessors(file, draco->accessors) : Accessors(file);
      PrimitiveReader in{
          file, accessors, source.primitives[p], place, 0, skinned[m], draco ? &draco->indices : nullptr};
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
