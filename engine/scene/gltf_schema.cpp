// SPDX-License-Identifier: MIT
#include "scene/gltf_schema.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

enum class Kind { object, objects, text, texts, boolean, integer, number, numbers, index, indices, index_map };

constexpr double any = std::numeric_limits<float>::max();  // numbers end up as float: larger ones would become infinite

struct Rule {
  const char* key;  // "" is the owner itself
  Kind kind;
  const char* of = "";  // index kinds: the collection they point into
  double lo = -any, hi = any;
  int size = 0;  // numbers: how many, 0 is any number
  bool required = false;
};

struct Group {
  std::string owner;  // "accessors[].sparse": [] stands for every element
  std::vector<Rule> rules;
};

constexpr double max_size = 9007199254740992.0;  // 2^53, what a JSON number holds exactly
constexpr double max_int = 2147483647.0;

std::vector<Group> storage_rules() {
  return {
      {"",
       {{"asset", Kind::object, "", -any, any, 0, true},
        {"scenes", Kind::objects},
        {"nodes", Kind::objects},
        {"meshes", Kind::objects},
        {"accessors", Kind::objects},
        {"bufferViews", Kind::objects},
        {"buffers", Kind::objects},
        {"materials", Kind::objects},
        {"textures", Kind::objects},
        {"images", Kind::objects},
        {"samplers", Kind::objects},
        {"skins", Kind::objects},
        {"cameras", Kind::objects},
        {"animations", Kind::objects},
        {"extensions", Kind::object},
        {"extensionsUsed", Kind::texts},
        {"extensionsRequired", Kind::texts},
        {"scene", Kind::index, "scenes"}}},
      {"asset", {{"version", Kind::text, "", -any, any, 0, true}, {"minVersion", Kind::text}}},
      {"scenes[]", {{"name", Kind::text}, {"nodes", Kind::indices, "nodes"}}},
      {"buffers[]", {{"uri", Kind::text}, {"byteLength", Kind::integer, "", 1, max_size, 0, true}}},
      {"bufferViews[]",
       {{"buffer", Kind::index, "buffers", -any, any, 0, true},
        {"byteOffset", Kind::integer, "", 0, max_size},
        {"byteLength", Kind::integer, "", 1, max_size, 0, true},
        {"byteStride", Kind::integer, "", 4, 252},
        {"target", Kind::integer, "", 0, max_int}}},
      {"accessors[]",
       {{"bufferView", Kind::index, "bufferViews"},
        {"byteOffset", Kind::integer, "", 0, max_size},
        {"componentType", Kind::integer, "", 5120, 5126, 0, true},
        {"normalized", Kind::boolean},
        {"count", Kind::integer, "", 1, max_size, 0, true},
        {"type", Kind::text, "", -any, any, 0, true},
        {"min", Kind::numbers},
        {"max", Kind::numbers},
        {"sparse", Kind::object}}},
      {"accessors[].sparse",
       {{"count", Kind::integer, "", 1, max_int, 0, true},
        {"indices", Kind::object, "", -any, any, 0, true},
        {"values", Kind::object, "", -any, any, 0, true}}},
      {"accessors[].sparse.indices",
       {{"bufferView", Kind::index, "bufferViews", -any, any, 0, true},
        {"byteOffset", Kind::integer, "", 0, max_int},
        {"componentType", Kind::integer, "", 5121, 5125, 0, true}}},
      {"accessors[].sparse.values",
       {{"bufferView", Kind::index, "bufferViews", -any, any, 0, true}, {"byteOffset", Kind::integer, "", 0, max_int}}},
      {"images[]", {{"uri", Kind::text}, {"mimeType", Kind::text}, {"bufferView", Kind::index, "bufferViews"}}},
      {"samplers[]",
       {{"magFilter", Kind::integer, "", 0, max_int},
        {"minFilter", Kind::integer, "", 0, max_int},
        {"wrapS", Kind::integer, "", 0, max_int},
        {"wrapT", Kind::integer, "", 0, max_int}}},
      {"textures[]", {{"sampler", Kind::index, "samplers"}, {"source", Kind::index, "images"}}},
  };
}

std::vector<Group> object_rules() {
  return {
      {"nodes[]",
       {{"name", Kind::text},
        {"children", Kind::indices, "nodes"},
        {"mesh", Kind::index, "meshes"},
        {"skin", Kind::index, "skins"},
        {"camera", Kind::index, "cameras"},
        {"matrix", Kind::numbers, "", -any, any, 16},
        {"translation", Kind::numbers, "", -any, any, 3},
        {"rotation", Kind::numbers, "", -any, any, 4},
        {"scale", Kind::numbers, "", -any, any, 3},
        {"weights", Kind::numbers},
        {"extensions", Kind::object}}},
      {"nodes[].extensions", {{"KHR_lights_punctual", Kind::object}, {"EXT_mesh_gpu_instancing", Kind::object}}},
      {"nodes[].extensions.KHR_lights_punctual", {{"light", Kind::index, "lights", -any, any, 0, true}}},
      {"nodes[].extensions.EXT_mesh_gpu_instancing",
       {{"attributes", Kind::index_map, "accessors", -any, any, 0, true}}},
      {"meshes[]",
       {{"name", Kind::text}, {"primitives", Kind::objects, "", -any, any, 0, true}, {"weights", Kind::numbers}}},
      {"meshes[].primitives[]",
       {{"attributes", Kind::index_map, "accessors", -any, any, 0, true},
        {"indices", Kind::index, "accessors"},
        {"material", Kind::index, "materials"},
        {"mode", Kind::integer, "", 0, 6},
        {"targets", Kind::objects},
        {"extensions", Kind::object}}},
      {"meshes[].primitives[].targets[]", {{"", Kind::index_map, "accessors"}}},
      {"skins[]",
       {{"joints", Kind::indices, "nodes", -any, any, 0, true},
        {"inverseBindMatrices", Kind::index, "accessors"},
        {"skeleton", Kind::index, "nodes"}}},
      {"cameras[]",
       {{"name", Kind::text},
        {"type", Kind::text, "", -any, any, 0, true},
        {"perspective", Kind::object},
        {"orthographic", Kind::object}}},
      {"cameras[].perspective",
       {{"aspectRatio", Kind::number, "", 0, any},
        {"yfov", Kind::number, "", 0, 3.141592653589793, 0, true},
        {"zfar", Kind::number, "", 0, any},
        {"znear", Kind::number, "", 0, any, 0, true}}},
      {"cameras[].orthographic",
       {{"xmag", Kind::number, "", -any, any, 0, true},
        {"ymag", Kind::number, "", -any, any, 0, true},
        {"zfar", Kind::number, "", 0, any, 0, true},
        {"znear", Kind::number, "", 0, any, 0, true}}},
      {"extensions", {{"KHR_lights_punctual", Kind::object}}},
      {"extensions.KHR_lights_punctual", {{"lights", Kind::objects}}},
      {"extensions.KHR_lights_punctual.lights[]",
       {{"name", Kind::text},
        {"type", Kind::text, "", -any, any, 0, true},
        {"color", Kind::numbers, "", 0, any, 3},
        {"intensity", Kind::number, "", 0, any},
        {"range", Kind::number, "", 0, any},
        {"spot", Kind::object}}},
      {"extensions.KHR_lights_punctual.lights[].spot",
       {{"innerConeAngle", Kind::number}, {"outerConeAngle", Kind::number}}},
      {"animations[]",
       {{"name", Kind::text},
        {"channels", Kind::objects, "", -any, any, 0, true},
        {"samplers", Kind::objects, "", -any, any, 0, true}}},
      {"animations[].samplers[]",
       {{"input", Kind::index, "accessors", -any, any, 0, true},
        {"output", Kind::index, "accessors", -any, any, 0, true},
        {"interpolation", Kind::text}}},
      {"animations[].channels[]",
       {{"sampler", Kind::integer, "", 0, max_int, 0, true}, {"target", Kind::object, "", -any, any, 0, true}}},
      {"animations[].channels[].target",
       {{"node", Kind::index, "nodes"}, {"path", Kind::text, "", -any, any, 0, true}}},
  };
}

std::vector<Group> material_rules() {
  std::vector<Group> groups = {
      {"materials[]",
       {{"name", Kind::text},
        {"pbrMetallicRoughness", Kind::object},
        {"normalTexture", Kind::object},
        {"occlusionTexture", Kind::object},
        {"emissiveTexture", Kind::object},
        {"emissiveFactor", Kind::numbers, "", -any, any, 3},
        {"alphaMode", Kind::text},
        {"alphaCutoff", Kind::number},
        {"doubleSided", Kind::boolean},
        {"extensions", Kind::object}}},
      {"materials[].pbrMetallicRoughness",
       {{"baseColorFactor", Kind::numbers, "", -any, any, 4},
        {"baseColorTexture", Kind::object},
        {"metallicFactor", Kind::number},
        {"roughnessFactor", Kind::number},
        {"metallicRoughnessTexture", Kind::object}}},
      {"materials[].extensions",
       {{"KHR_materials_emissive_strength", Kind::object},
        {"KHR_materials_unlit", Kind::object},
        {"KHR_materials_transmission", Kind::object},
        {"KHR_materials_ior", Kind::object},
        {"KHR_materials_volume", Kind::object}}},
      {"materials[].extensions.KHR_materials_emissive_strength", {{"emissiveStrength", Kind::number}}},
      {"materials[].extensions.KHR_materials_transmission",
       {{"transmissionFactor", Kind::number}, {"transmissionTexture", Kind::object}}},
      {"materials[].extensions.KHR_materials_ior", {{"ior", Kind::number}}},
      {"materials[].extensions.KHR_materials_volume",
       {{"thicknessFactor", Kind::number},
        {"thicknessTexture", Kind::object},
        {"attenuationDistance", Kind::number},
        {"attenuationColor", Kind::numbers, "", -any, any, 3}}},
  };
  for (const char* slot :
       {"pbrMetallicRoughness.baseColorTexture", "pbrMetallicRoughness.metallicRoughnessTexture", "normalTexture",
        "occlusionTexture", "emissiveTexture", "extensions.KHR_materials_transmission.transmissionTexture",
        "extensions.KHR_materials_volume.thicknessTexture"}) {
    const std::string owner = std::string("materials[].") + slot;
    groups.push_back({owner,
                      {{"index", Kind::index, "textures", -any, any, 0, true},
                       {"texCoord", Kind::integer, "", 0, max_int},
                       {"scale", Kind::number},
                       {"strength", Kind::number},
                       {"extensions", Kind::object}}});
    groups.push_back({owner + ".extensions", {{"KHR_texture_transform", Kind::object}}});
    groups.push_back({owner + ".extensions.KHR_texture_transform",
                      {{"offset", Kind::numbers, "", -any, any, 2},
                       {"scale", Kind::numbers, "", -any, any, 2},
                       {"rotation", Kind::number},
                       {"texCoord", Kind::integer, "", 0, max_int}}});
  }
  return groups;
}

class Checker {
 public:
  Checker(const json& document, const std::string& file) : document_(document), file_(file) {}

  void check(const Group& group) const {
    visit(document_, group.owner, "", [&](const json& owner, const std::string& place) {
      for (const Rule& rule : group.rules) check_rule(owner, place, rule);
    });
  }

  void check_channel_samplers() const {
    visit(document_, "animations[]", "", [&](const json& animation, const std::string& place) {
      const std::size_t count = animation.at("samplers").size();
      visit(animation, "channels[]", place + ".", [&](const json& channel, const std::string& channel_place) {
        if (channel.at("sampler").get<std::uint64_t>() >= count) {
          fail(channel_place + ".sampler", "out of range, the animation has " + std::to_string(count) + " samplers");
        }
      });
    });
  }

  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw input_error(file_ + ": " + place, reason);
  }

 private:
  using Visitor = std::function<void(const json&, const std::string&)>;

  // Depth is that of the pattern, not of the document.
  void visit(const json& at, std::string_view pattern, const std::string& place, const Visitor& visitor) const {
    if (pattern.empty()) {
      visitor(at, place.empty() || place.back() != '.' ? place : place.substr(0, place.size() - 1));
      return;
    }
    const std::size_t dot = pattern.find('.');
    std::string_view segment = pattern.substr(0, dot);
    const std::string_view rest = dot == std::string_view::npos ? std::string_view{} : pattern.substr(dot + 1);
    const bool each = segment.ends_with("[]");
    if (each) segment.remove_suffix(2);
    const auto found = at.find(segment);
    if (found == at.end()) return;
    if (!each) {
      visit(*found, rest, place + std::string(segment) + ".", visitor);
      return;
    }
    for (std::size_t i = 0; i < found->size(); ++i) {
      visit((*found)[i], rest, place + std::string(segment) + "[" + std::to_string(i) + "].", visitor);
    }
  }

  void check_rule(const json& owner, const std::string& owner_place, const Rule& rule) const {
    const json* value = &owner;
    std::string place = owner_place;
    if (*rule.key != '\0') {
      const auto found = owner.find(rule.key);
      if (found == owner.end()) {
        if (rule.required) fail(owner_place.empty() ? "document" : owner_place, std::string(rule.key) + " is missing");
        return;
      }
      value = &*found;
      place += (place.empty() ? "" : ".") + std::string(rule.key);
    }
    check_value(*value, place, rule);
  }

  void check_value(const json& value, const std::string& place, const Rule& rule) const {
    const auto want = [&](bool right, const char* what) {
      if (!right) fail(place, std::string("must be ") + what + ", not " + value.type_name());
    };
    switch (rule.kind) {
      case Kind::object:
        return want(value.is_object(), "an object");
      case Kind::text:
        return want(value.is_string(), "a string");
      case Kind::boolean:
        return want(value.is_boolean(), "true or false");
      case Kind::number:
        return check_number(value, place, rule);
      case Kind::integer:
        return check_integer(value, place, rule);
      case Kind::index:
        return check_index(value, place, rule.of);
      case Kind::index_map:
        want(value.is_object(), "an object");
        for (const auto& [name, index] : value.items()) check_index(index, place + "." + name, rule.of);
        return;
      default:
        break;
    }
    want(value.is_array(), "an array");
    if (rule.size > 0 && value.size() != static_cast<std::size_t>(rule.size)) {
      fail(place, "must hold " + std::to_string(rule.size) + " numbers, not " + std::to_string(value.size()));
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
      const std::string element = place + "[" + std::to_string(i) + "]";
      if (rule.kind == Kind::numbers) check_number(value[i], element, rule);
      if (rule.kind == Kind::indices) check_index(value[i], element, rule.of);
      if (rule.kind == Kind::objects && !value[i].is_object()) fail(element, "must be an object");
      if (rule.kind == Kind::texts && !value[i].is_string()) fail(element, "must be a string");
    }
  }

  void check_number(const json& value, const std::string& place, const Rule& rule) const {
    if (!value.is_number()) fail(place, std::string("must be a number, not ") + value.type_name());
    const double number = value.get<double>();
    if (!(number >= rule.lo && number <= rule.hi)) fail(place, value.dump() + " is out of range");
  }

  void check_integer(const json& value, const std::string& place, const Rule& rule) const {
    if (!value.is_number_integer())
      fail(place, std::string("must be a whole number, not ") + value.dump().substr(0, 40));
    const double number = value.get<double>();
    if (number < rule.lo || number > rule.hi) fail(place, value.dump() + " is out of range");
  }

  void check_index(const json& value, const std::string& place, const std::string& of) const {
    const std::size_t count = of == "lights" ? light_count() : document_.contains(of) ? document_.at(of).size() : 0;
    if (!value.is_number_integer()) fail(place, "must be an index, not " + value.dump().substr(0, 40));
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count) {
      fail(place, value.dump() + " is out of range, the file has " + std::to_string(count) + " " + of);
    }
  }

  [[nodiscard]] std::size_t light_count() const {
    const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
    return document_.contains(lights) && document_.at(lights).is_array() ? document_.at(lights).size() : 0;
  }

  const json& document_;
  const std::string& file_;
};

// tinygltf hands an image's bytes to its reader without looking whether the view lies inside the buffer.
void check_view_ranges(const json& document, const Checker& checker) {
  if (!document.contains("bufferViews")) return;
  const json& views = document.at("bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto size =
        document.at("buffers").at(views[i].at("buffer").get<std::size_t>()).at("byteLength").get<std::uint64_t>();
    const auto offset = views[i].value("byteOffset", std::uint64_t{0});
    const auto length = views[i].at("byteLength").get<std::uint64_t>();
    if (offset > size || length > size - offset) {
      checker.fail("bufferViews[" + std::to_string(i) + "]",
                   "bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                       " are outside buffers[" + views[i].at("buffer").dump() + "] of " + std::to_string(size) +
                       " bytes");
    }
    if (views[i].contains("byteStride") && views[i].at("byteStride").get<int>() % 4 != 0) {
      checker.fail("bufferViews[" + std::to_string(i) + "].byteStride", "must be a multiple of 4");
    }
  }
}

}  // namespace

void check_gltf_document(const json& document, const std::string& file) {
  const Checker checker(document, file);
  if (!document.is_object()) checker.fail("document", std::string("must be an object, not ") + document.type_name());
  for (const Group& group : storage_rules()) checker.check(group);
  const std::string version = document.at("asset").at("version").get<std::string>();
  const std::string minimum = document.at("asset").value("minVersion", version);
  if (!version.starts_with("2.")) checker.fail("asset.version", "\"" + version + "\" is not supported, only 2.x is");
  if (minimum != version && minimum != "2.0") {
    checker.fail("asset.minVersion", "\"" + minimum + "\" is not supported, only 2.0 is");
  }
  for (const Group& group : object_rules()) checker.check(group);
  for (const Group& group : material_rules()) checker.check(group);
  checker.check_channel_samplers();
  check_view_ranges(document, checker);
}

}  // namespace sheaf
