// SPDX-License-Identifier: MIT
#include "scene/gltf_schema_rules.hpp"

#include <algorithm>
#include <string_view>

#include "interface/material_table.h"

namespace sheaf {
namespace {

constexpr double any = schema_any, max_size = schema_max_size, max_int = schema_max_int;

std::vector<SchemaRule> meshopt_rules() {
  return {{"buffer", JsonKind::index, "buffers", -any, any, 0, true},
          {"byteOffset", JsonKind::integer, "", 0, max_size},
          {"byteLength", JsonKind::integer, "", 1, max_size, 0, true},
          {"byteStride", JsonKind::integer, "", 2, 256, 0, true},
          {"count", JsonKind::integer, "", 1, max_size, 0, true},
          {"mode", JsonKind::text, "", -any, any, 0, true},
          {"filter", JsonKind::text}};
}

std::vector<SchemaGroup> storage_rules() {
  return {
      {"",
       {{"asset", JsonKind::object, "", -any, any, 0, true},
        {"scenes", JsonKind::objects},
        {"nodes", JsonKind::objects},
        {"meshes", JsonKind::objects},
        {"accessors", JsonKind::objects},
        {"bufferViews", JsonKind::objects},
        {"buffers", JsonKind::objects},
        {"materials", JsonKind::objects},
        {"textures", JsonKind::objects},
        {"images", JsonKind::objects},
        {"samplers", JsonKind::objects},
        {"skins", JsonKind::objects},
        {"cameras", JsonKind::objects},
        {"animations", JsonKind::objects},
        {"extensions", JsonKind::object},
        {"extensionsUsed", JsonKind::texts},
        {"extensionsRequired", JsonKind::texts},
        {"scene", JsonKind::index, "scenes"}}},
      {"asset", {{"version", JsonKind::text, "", -any, any, 0, true}, {"minVersion", JsonKind::text}}},
      {"scenes[]", {{"name", JsonKind::text}, {"nodes", JsonKind::indices, "nodes"}}},
      {"buffers[]", {{"uri", JsonKind::text}, {"byteLength", JsonKind::integer, "", 1, max_size, 0, true}}},
      {"bufferViews[]",
       {{"buffer", JsonKind::index, "buffers", -any, any, 0, true},
        {"byteOffset", JsonKind::integer, "", 0, max_size},
        {"byteLength", JsonKind::integer, "", 1, max_size, 0, true},
        {"byteStride", JsonKind::integer, "", 4, 252},
        {"target", JsonKind::integer, "", 0, max_int},
        {"extensions", JsonKind::object}}},
      {"bufferViews[].extensions",
       {{"EXT_meshopt_compression", JsonKind::object}, {"KHR_meshopt_compression", JsonKind::object}}},
      {"bufferViews[].extensions.EXT_meshopt_compression", meshopt_rules()},
      {"bufferViews[].extensions.KHR_meshopt_compression", meshopt_rules()},
      {"accessors[]",
       {{"bufferView", JsonKind::index, "bufferViews"},
        {"byteOffset", JsonKind::integer, "", 0, max_size},
        {"componentType", JsonKind::integer, "", 5120, 5126, 0, true},
        {"normalized", JsonKind::boolean},
        {"count", JsonKind::integer, "", 1, max_size, 0, true},
        {"type", JsonKind::text, "", -any, any, 0, true},
        {"min", JsonKind::numbers},
        {"max", JsonKind::numbers},
        {"sparse", JsonKind::object}}},
      {"accessors[].sparse",
       {{"count", JsonKind::integer, "", 1, max_int, 0, true},
        {"indices", JsonKind::object, "", -any, any, 0, true},
        {"values", JsonKind::object, "", -any, any, 0, true}}},
      {"accessors[].sparse.indices",
       {{"bufferView", JsonKind::index, "bufferViews", -any, any, 0, true},
        {"byteOffset", JsonKind::integer, "", 0, max_int},
        {"componentType", JsonKind::integer, "", 5121, 5125, 0, true}}},
      {"accessors[].sparse.values",
       {{"bufferView", JsonKind::index, "bufferViews", -any, any, 0, true},
        {"byteOffset", JsonKind::integer, "", 0, max_int}}},
      {"images[]",
       {{"uri", JsonKind::text}, {"mimeType", JsonKind::text}, {"bufferView", JsonKind::index, "bufferViews"}}},
      {"samplers[]",
       {{"magFilter", JsonKind::integer, "", 0, max_int},
        {"minFilter", JsonKind::integer, "", 0, max_int},
        {"wrapS", JsonKind::integer, "", 0, max_int},
        {"wrapT", JsonKind::integer, "", 0, max_int}}},
      {"textures[]",
       {{"sampler", JsonKind::index, "samplers"},
        {"source", JsonKind::index, "images"},
        {"extensions", JsonKind::object}}},
      {"textures[].extensions",
       {{"EXT_texture_webp", JsonKind::object},
        {"KHR_texture_basisu", JsonKind::object},
        {"MSFT_texture_dds", JsonKind::object}}},
      {"textures[].extensions.MSFT_texture_dds", {{"source", JsonKind::index, "images"}}},
      {"textures[].extensions.KHR_texture_basisu", {{"source", JsonKind::index, "images"}}},
      {"textures[].extensions.EXT_texture_webp", {{"source", JsonKind::index, "images"}}},
  };
}

std::vector<SchemaGroup> object_rules() {
  return {
      {"nodes[]",
       {{"name", JsonKind::text},
        {"children", JsonKind::indices, "nodes"},
        {"mesh", JsonKind::index, "meshes"},
        {"skin", JsonKind::index, "skins"},
        {"camera", JsonKind::index, "cameras"},
        {"matrix", JsonKind::numbers, "", -any, any, 16},
        {"translation", JsonKind::numbers, "", -any, any, 3},
        {"rotation", JsonKind::numbers, "", -any, any, 4},
        {"scale", JsonKind::numbers, "", -any, any, 3},
        {"weights", JsonKind::numbers},
        {"extensions", JsonKind::object}}},
      {"nodes[].extensions",
       {{"KHR_lights_punctual", JsonKind::object},
        {"EXT_mesh_gpu_instancing", JsonKind::object},
        {"KHR_node_visibility", JsonKind::object},
        {"MSFT_lod", JsonKind::object}}},
      {"nodes[].extensions.KHR_node_visibility", {{"visible", JsonKind::boolean}}},
      {"nodes[].extensions.MSFT_lod", {{"ids", JsonKind::indices, "nodes", -any, any, 0, true}}},
      {"nodes[].extensions.KHR_lights_punctual", {{"light", JsonKind::index, "lights", -any, any, 0, true}}},
      {"nodes[].extensions.EXT_mesh_gpu_instancing",
       {{"attributes", JsonKind::index_map, "accessors", -any, any, 0, true}}},
      {"meshes[]",
       {{"name", JsonKind::text},
        {"primitives", JsonKind::objects, "", -any, any, 0, true},
        {"weights", JsonKind::numbers}}},
      {"meshes[].primitives[]",
       {{"attributes", JsonKind::index_map, "accessors", -any, any, 0, true},
        {"indices", JsonKind::index, "accessors"},
        {"material", JsonKind::index, "materials"},
        {"mode", JsonKind::integer, "", 0, 6},
        {"targets", JsonKind::objects},
        {"extensions", JsonKind::object}}},
      {"meshes[].primitives[].extensions",
       {{"KHR_draco_mesh_compression", JsonKind::object}, {"KHR_materials_variants", JsonKind::object}}},
      {"meshes[].primitives[].extensions.KHR_materials_variants",
       {{"mappings", JsonKind::objects, "", -any, any, 0, true}}},
      {"meshes[].primitives[].extensions.KHR_materials_variants.mappings[]",
       {{"material", JsonKind::index, "materials", -any, any, 0, true}, {"variants", JsonKind::numbers}}},
      {"meshes[].primitives[].extensions.KHR_draco_mesh_compression",
       {{"bufferView", JsonKind::index, "bufferViews", -any, any, 0, true},
        {"attributes", JsonKind::object, "", -any, any, 0, true}}},
      {"meshes[].primitives[].targets[]", {{"", JsonKind::index_map, "accessors"}}},
      {"skins[]",
       {{"joints", JsonKind::indices, "nodes", -any, any, 0, true},
        {"inverseBindMatrices", JsonKind::index, "accessors"},
        {"skeleton", JsonKind::index, "nodes"}}},
      {"cameras[]",
       {{"name", JsonKind::text},
        {"type", JsonKind::text, "", -any, any, 0, true},
        {"perspective", JsonKind::object},
        {"orthographic", JsonKind::object}}},
      {"cameras[].perspective",
       {{"aspectRatio", JsonKind::number, "", 0, any},
        {"yfov", JsonKind::number, "", 0, 3.141592653589793, 0, true},
        {"zfar", JsonKind::number, "", 0, any},
        {"znear", JsonKind::number, "", 0, any, 0, true}}},
      {"cameras[].orthographic",
       {{"xmag", JsonKind::number, "", -any, any, 0, true},
        {"ymag", JsonKind::number, "", -any, any, 0, true},
        {"zfar", JsonKind::number, "", 0, any, 0, true},
        {"znear", JsonKind::number, "", 0, any, 0, true}}},
      {"extensions", {{"KHR_lights_punctual", JsonKind::object}, {"KHR_materials_variants", JsonKind::object}}},
      {"extensions.KHR_materials_variants", {{"variants", JsonKind::objects, "", -any, any, 0, true}}},
      {"extensions.KHR_lights_punctual", {{"lights", JsonKind::objects}}},
      {"extensions.KHR_lights_punctual.lights[]",
       {{"name", JsonKind::text},
        {"type", JsonKind::text, "", -any, any, 0, true},
        {"color", JsonKind::numbers, "", 0, any, 3},
        {"intensity", JsonKind::number, "", 0, any},
        {"range", JsonKind::number, "", 0, any},
        {"spot", JsonKind::object}}},
      {"extensions.KHR_lights_punctual.lights[].spot",
       {{"innerConeAngle", JsonKind::number}, {"outerConeAngle", JsonKind::number}}},
      {"animations[]",
       {{"name", JsonKind::text},
        {"channels", JsonKind::objects, "", -any, any, 0, true},
        {"samplers", JsonKind::objects, "", -any, any, 0, true}}},
      {"animations[].samplers[]",
       {{"input", JsonKind::index, "accessors", -any, any, 0, true},
        {"output", JsonKind::index, "accessors", -any, any, 0, true},
        {"interpolation", JsonKind::text}}},
      {"animations[].channels[]",
       {{"sampler", JsonKind::integer, "", 0, max_int, 0, true}, {"target", JsonKind::object, "", -any, any, 0, true}}},
      {"animations[].channels[].target",
       {{"node", JsonKind::index, "nodes"}, {"path", JsonKind::text, "", -any, any, 0, true}}},
  };
}

// Where the table of materials has its owners: "materials[]", what it holds, and its extensions.
std::string path_of(const std::string& owner) {
  if (owner == "material") return "materials[]";
  return (owner == "pbrMetallicRoughness" ? "materials[]." : "materials[].extensions.") + owner;
}

void add_rule(std::vector<SchemaGroup>& groups, const std::string& owner, const SchemaRule& rule) {
  auto found = std::find_if(groups.begin(), groups.end(), [&](const auto& group) { return group.owner == owner; });
  if (found == groups.end()) found = groups.insert(found, {owner, {}});
  const std::string_view key = rule.key;
  if (std::none_of(found->rules.begin(), found->rules.end(), [&](const auto& known) { return known.key == key; }))
    found->rules.push_back(rule);
}

void add_texture_rules(std::vector<SchemaGroup>& groups, const std::string& owner) {
  groups.push_back({owner,
                    {{"index", JsonKind::index, "textures", -any, any, 0, true},
                     {"texCoord", JsonKind::integer, "", 0, max_int},
                     {"scale", JsonKind::number},
                     {"strength", JsonKind::number},
                     {"extensions", JsonKind::object}}});
  groups.push_back({owner + ".extensions", {{"KHR_texture_transform", JsonKind::object}}});
  groups.push_back({owner + ".extensions.KHR_texture_transform",
                    {{"offset", JsonKind::numbers, "", -any, any, 2},
                     {"scale", JsonKind::numbers, "", -any, any, 2},
                     {"rotation", JsonKind::number},
                     {"texCoord", JsonKind::integer, "", 0, max_int}}});
}

// What the table does not have, and for each of its lines a rule.
std::vector<SchemaGroup> material_rules() {
  std::vector<SchemaGroup> groups = {
      {"materials[]",
       {{"name", JsonKind::text},
        {"pbrMetallicRoughness", JsonKind::object},
        {"alphaMode", JsonKind::text},
        {"doubleSided", JsonKind::boolean},
        {"extensions", JsonKind::object}}},
      {"materials[].extensions",
       {{"KHR_materials_emissive_strength", JsonKind::object},
        {"MSFT_lod", JsonKind::object},
        {"KHR_materials_unlit", JsonKind::object},
        {"KHR_materials_pbrSpecularGlossiness", JsonKind::object},
        {"KHR_materials_volume", JsonKind::object}}},
      {"materials[].extensions.KHR_materials_pbrSpecularGlossiness",
       {{"diffuseFactor", JsonKind::numbers, "", -any, any, 4},
        {"specularFactor", JsonKind::numbers, "", -any, any, 3},
        {"glossinessFactor", JsonKind::number},
        {"diffuseTexture", JsonKind::object},
        {"specularGlossinessTexture", JsonKind::object}}},
      {"materials[].extensions.MSFT_lod", {{"ids", JsonKind::indices, "materials", -any, any, 0, true}}},
      {"materials[].extensions.KHR_materials_emissive_strength", {{"emissiveStrength", JsonKind::number}}},
      {"materials[].extensions.KHR_materials_volume",
       {{"thicknessFactor", JsonKind::number},
        {"thicknessTexture", JsonKind::object},
        {"attenuationDistance", JsonKind::number},
        {"attenuationColor", JsonKind::numbers, "", -any, any, 3}}},
  };
  const auto add = [&](const std::string& owner, const char* name, const SchemaRule& rule) {
    if (owner.starts_with("KHR_")) add_rule(groups, "materials[].extensions", {name, JsonKind::object});
    add_rule(groups, path_of(owner), rule);
  };
#define SHEAF_FACTOR(type, words, field, value, owner, key, low, high) \
  add(#owner, #owner,                                                  \
      {#key, (words) == 1 ? JsonKind::number : JsonKind::numbers, "", -any, any, (words) == 1 ? 0 : int{words}});
#define SHEAF_TEXTURE(number, place, field, owner, key, content) add(#owner, #owner, {#key, JsonKind::object});
  MATERIAL_FACTORS(SHEAF_FACTOR)
  MATERIAL_TEXTURES(SHEAF_TEXTURE)
#undef SHEAF_FACTOR
#undef SHEAF_TEXTURE
#define SHEAF_TEXTURE(number, place, field, owner, key, content) add_texture_rules(groups, path_of(#owner) + "." #key);
  MATERIAL_TEXTURES(SHEAF_TEXTURE)
#undef SHEAF_TEXTURE
  add_texture_rules(groups, "materials[].extensions.KHR_materials_volume.thicknessTexture");
  for (const char* key : {"diffuseTexture", "specularGlossinessTexture"})
    add_texture_rules(groups, std::string("materials[].extensions.KHR_materials_pbrSpecularGlossiness.") + key);
  return groups;
}

}  // namespace

std::vector<SchemaGroup> schema_rules() {
  std::vector<SchemaGroup> all = storage_rules();
  for (const auto& part : {object_rules(), material_rules()}) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace sheaf
