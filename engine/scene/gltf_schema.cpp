// SPDX-License-Identifier: MIT
#include "scene/gltf_schema.hpp"

#include <algorithm>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "scene/gltf_schema_rules.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

constexpr const char* lights = "extensions.KHR_lights_punctual.lights";

class Checker {
 public:
  explicit Checker(const json& document) : document_(document) {}

  void check(const SchemaGroup& group) {
    const auto check_owner = [&](const json& owner, const std::string& place) {
      for (const SchemaRule& rule : group.rules) check_rule(owner, place, rule);
    };
    const std::string_view owner = group.owner;
    const std::size_t brackets = owner.find("[]");
    if (brackets == std::string_view::npos) return visit(document_, owner, "", check_owner);
    const std::string_view rest = owner.substr(std::min(brackets + 3, owner.size()));
    each(std::string(owner.substr(0, brackets)),
         [&](const json& element, const std::string& place) { visit(element, rest, place + ".", check_owner); });
  }

  void check_relations() {
    each("animations", [&](const json& animation, const std::string& place) { check_channels(animation, place); });
    each("cameras", [&](const json& camera, const std::string& place) {
      const auto type = camera.at("type").get<std::string>();
      if (type != "perspective" && type != "orthographic") fail(place + ".type", "is not perspective or orthographic");
      if (!camera.contains(type)) fail(place + "." + type, "is missing");
    });
    each("bufferViews", [&](const json& view, const std::string& place) {
      if (view.value("byteStride", 4) % 4 != 0) fail(place + ".byteStride", "must be a multiple of 4");
    });
    each("accessors", [&](const json& accessor, const std::string& place) {
      const auto type = accessor.at("type").get<std::string>();
      for (const char* known : {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"})
        if (type == known) return;
      fail(place + ".type", in_quotes(type) + " is not SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
    });
  }

  [[noreturn]] static void fail(const std::string& place, const std::string& reason) { throw Fault{place, reason}; }

  [[nodiscard]] BrokenObjects take_broken() { return std::move(broken_); }

 private:
  using Visitor = std::function<void(const json&, const std::string&)>;

  static std::string collection_of(const std::string& list) { return list.substr(list.rfind('.') + 1); }

  // Every element that is not known to be broken. What `visitor` throws marks its element.
  void each(const std::string& list, const Visitor& visitor) {
    visit(document_, list, "", [&](const json& elements, const std::string& place) {
      for (std::size_t i = 0; i < elements.size(); ++i) {
        if (broken_.find(collection_of(list), i)) continue;
        try {
          visitor(elements[i], place + "[" + std::to_string(i) + "]");
        } catch (const Fault& fault) {
          broken_.mark(collection_of(list), i, fault);
        }
      }
    });
  }

  void check_channels(const json& animation, const std::string& place) const {
    const std::size_t count = animation.at("samplers").size();
    visit(animation, "channels[]", place + ".", [&](const json& channel, const std::string& channel_place) {
      if (channel.at("sampler").get<std::uint64_t>() >= count) {
        fail(channel_place + ".sampler", "out of range, the animation has " + std::to_string(count) + " samplers");
      }
    });
  }

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

  void check_rule(const json& owner, const std::string& owner_place, const SchemaRule& rule) {
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

  void check_value(const json& value, const std::string& place, const SchemaRule& rule) {
    const auto want = [&](bool right, const char* what) {
      if (!right) fail(place, std::string("must be ") + what + ", not " + value.type_name());
    };
    switch (rule.kind) {
      case JsonKind::object:
        return want(value.is_object(), "an object");
      case JsonKind::text:
        return want(value.is_string(), "a string");
      case JsonKind::boolean:
        return want(value.is_boolean(), "true or false");
      case JsonKind::number:
        return check_number(value, place, rule);
      case JsonKind::integer:
        return check_integer(value, place, rule);
      case JsonKind::index:
        return check_index(value, place, rule.of);
      case JsonKind::index_map:
        want(value.is_object(), "an object");
        for (const auto& [name, index] : value.items()) check_index(index, place + "." + quote(name), rule.of);
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
      if (rule.kind == JsonKind::numbers) check_number(value[i], element, rule);
      if (rule.kind == JsonKind::indices) check_index(value[i], element, rule.of);
      if (rule.kind == JsonKind::objects && !value[i].is_object()) check_element(place, i);
      if (rule.kind == JsonKind::texts && !value[i].is_string()) fail(element, "must be a string");
    }
  }

  // An element that is no object: of the document's collections it is broken, and of an object's own list the object
  // is.
  void check_element(const std::string& list, std::size_t index) {
    const Fault fault{list + "[" + std::to_string(index) + "]", "must be an object"};
    const bool of_document = list.find('.') == std::string::npos || list == lights;
    if (!of_document) throw Fault(fault);
    broken_.mark(collection_of(list), index, fault);
  }

  void check_number(const json& value, const std::string& place, const SchemaRule& rule) const {
    if (!value.is_number()) fail(place, std::string("must be a number, not ") + value.type_name());
    const double number = value.get<double>();
    if (!(number >= rule.lo && number <= rule.hi)) fail(place, value.dump() + " is out of range");
  }

  void check_integer(const json& value, const std::string& place, const SchemaRule& rule) const {
    if (!value.is_number_integer()) fail(place, std::string("must be a whole number, not ") + quote(value.dump(), 40));
    const double number = value.get<double>();
    if (number < rule.lo || number > rule.hi) fail(place, value.dump() + " is out of range");
  }

  void check_index(const json& value, const std::string& place, const std::string& of) const {
    const std::size_t count = of == "lights" ? light_count() : document_.contains(of) ? document_.at(of).size() : 0;
    if (!value.is_number_integer()) fail(place, "must be an index, not " + quote(value.dump(), 40));
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count) {
      fail(place, value.dump() + " is out of range, the file has " + std::to_string(count) + " " + of);
    }
  }

  [[nodiscard]] std::size_t light_count() const {
    const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
    return document_.contains(lights) && document_.at(lights).is_array() ? document_.at(lights).size() : 0;
  }

  const json& document_;
  BrokenObjects broken_;
};

json blank(const std::string& collection) {
  if (collection == "accessors") return {{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
  if (collection == "bufferViews") return {{"buffer", 0}, {"byteLength", 1}};
  if (collection == "buffers") return {{"byteLength", 1}};
  if (collection == "meshes") return {{"primitives", json::array()}};
  if (collection == "skins") return {{"joints", json::array()}};
  if (collection == "cameras") return {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}};
  if (collection == "animations") return {{"channels", json::array()}, {"samplers", json::array()}};
  if (collection == "lights") return {{"type", "point"}};
  return json::object();
}

void put_blanks(json& document, const BrokenObjects& broken) {
  for (const auto& [collection, faults] : broken.all()) {
    json& list =
        collection == "lights" ? document["extensions"]["KHR_lights_punctual"]["lights"] : document[collection];
    for (const auto& [index, fault] : faults) list[index] = blank(collection);
  }
}

// Whose JSON it is that has no `asset`.
std::string other_document(const json& document) {
  if (document.contains("camera_path") || document.contains("keys")) return ": this is a camera path";
  if (document.contains("metadata") && document.contains("object")) return ": this is JSON of three.js";
  if (document.contains("meshes") && document.at("meshes").is_object())
    return ": this is glTF 1.0, only 2.0 is supported";
  return "";
}

void check_version(const json& document) {
  const std::string version = document.at("asset").at("version").get<std::string>();
  const std::string minimum = document.at("asset").value("minVersion", version);
  if (version.starts_with("1.") || version == "0.8")
    Checker::fail("asset.version",
                  in_quotes(version) +
                      " is not supported, only 2.x is: convert the file, for example by \"gltf-pipeline "
                      "-i OLD.gltf -o NEW.gltf\"");
  if (!version.starts_with("2.") && version != "2")
    Checker::fail("asset.version", in_quotes(version) + " is not supported, only 2.x is");
  if (minimum != version && minimum != "2.0")
    Checker::fail("asset.minVersion", in_quotes(minimum) + " is not supported, only 2.0 is");
}

}  // namespace

BrokenObjects check_gltf_document(json& document, const std::string& file) {
  try {
    if (!document.is_object()) Checker::fail("document", std::string("must be an object, not ") + document.type_name());
    if (!document.contains("asset")) Checker::fail("document", "asset is missing" + other_document(document));
    Checker checker(document);
    const std::vector<SchemaGroup> groups = schema_rules();
    for (const SchemaGroup& group : groups)
      if (group.owner == "asset") checker.check(group);
    check_version(document);  // before what glTF 1.0 writes otherwise is refused piece by piece
    for (const SchemaGroup& group : groups) checker.check(group);
    checker.check_relations();
    BrokenObjects broken = checker.take_broken();
    put_blanks(document, broken);
    return broken;
  } catch (const Fault& fault) {
    throw input_error(file + ": " + fault.place, fault.reason);
  }
}

}  // namespace sheaf
