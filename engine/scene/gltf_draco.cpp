// SPDX-License-Identifier: MIT
#include "scene/gltf_draco.hpp"

#include <utility>

#include "scene/draco_mesh.hpp"
#include "scene/gltf_extensions.hpp"

namespace sheaf {

#ifdef SHEAF_HAS_DRACO
namespace {

using nlohmann::json;

constexpr const char* draco_name = "KHR_draco_mesh_compression";

// Which accessors the compressed data holds, and what each wants of it.
struct Wanted {
  std::vector<int> accessors;
  std::vector<DracoAttribute> attributes;
};

Wanted wanted_of(const GltfFile& file, const json& compressed, const tinygltf::Primitive& primitive,
                 const std::string& place) {
  Wanted wanted;
  for (const auto& [name, id] : compressed.at("attributes").items()) {
    const std::string attribute = place + ".attributes." + quote(name, 40);
    if (!id.is_number_unsigned() || id.get<std::uint64_t>() > 0xffffffff)
      file.fail(attribute, "must be the id of an attribute, not " + quote(id.dump(), 40));
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end()) {
      file.warn(attribute, "is ignored: the primitive has no such attribute");
      continue;
    }
    file.require("accessors", static_cast<std::size_t>(found->second));
    const tinygltf::Accessor& accessor = file.model.accessors[static_cast<std::size_t>(found->second)];
    wanted.accessors.push_back(found->second);
    wanted.attributes.push_back({id.get<std::uint32_t>(), accessor.componentType,
                                 tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type))});
  }
  return wanted;
}

// What accessors say of themselves must be what was decoded, which alone is there and is used.
void check_count(const GltfFile& file, int accessor, std::size_t decoded, const char* what) {
  if (accessor < 0) return;
  const auto index = static_cast<std::size_t>(accessor);
  if (file.model.accessors[index].count != decoded)
    file.warn(at("accessors", index) + ".count", "is " + std::to_string(file.model.accessors[index].count) + ", the " +
                                                     draco_name + " data has " + std::to_string(decoded) + " " + what);
}

}  // namespace

std::optional<DracoPrimitive> read_draco(const GltfFile& file, std::size_t m, std::size_t p, const std::string& place) {
  const json* const compressed = extension(file.json.at("meshes").at(m).at("primitives").at(p), draco_name);
  const tinygltf::Primitive& primitive = file.model.meshes[m].primitives[p];
  if (compressed == nullptr || primitive.mode < TINYGLTF_MODE_TRIANGLES) return std::nullopt;
  const std::string data_place = place + "." + draco_name;
  const Wanted wanted = wanted_of(file, *compressed, primitive, data_place);
  const BufferView view = file.bytes->view(file, compressed->at("bufferView").get<std::size_t>());
  DracoMesh mesh = decode_draco(view.bytes, wanted.attributes,
                                {file.limits.triangles, file.limits.vertices, file.limits.file_bytes});
  if (mesh.over_limit) file.over_limit(data_place, mesh.fault);
  if (!mesh.fault.empty()) file.fail(data_place, mesh.fault);
  check_count(file, primitive.indices, mesh.indices.size(), "indices");
  DracoPrimitive out;
  for (std::size_t i = 0; i < wanted.accessors.size(); ++i) {
    check_count(file, wanted.accessors[i], mesh.vertices, "vertices");
    out.accessors[wanted.accessors[i]] = {mesh.vertices, std::move(mesh.attributes[i])};
  }
  out.indices = std::move(mesh.indices);
  return out;
}
#else
std::optional<DracoPrimitive> read_draco(const GltfFile&, std::size_t, std::size_t, const std::string&) {
  return std::nullopt;
}
#endif

}  // namespace sheaf
