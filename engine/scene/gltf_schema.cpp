// SPDX-License-Identifier: MIT
#include "scene/gltf_schema.hpp"

#include <functional>
#include <string_view>

#include "core/error.hpp"
#include "scene/gltf_schema_rules.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

class Checker {
 public:
  Checker(const json& document, const std::string& file) : document_(document), file_(file) {}

  void check(const SchemaGroup& group) const {
    visit(document_, group.owner, "", [&](const json& owner, const std::string& place) {
      for (const SchemaRule& rule : group.rules) check_rule(owner, place, rule);
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

  void check_camera_types() const {
    visit(document_, "cameras[]", "", [&](const json& camera, const std::string& place) {
      const auto type = camera.at("type").get<std::string>();
      if (type != "perspective" && type != "orthographic") fail(place + ".type", "is not perspective or orthographic");
      if (!camera.contains(type)) fail(place + "." + type, "is missing");
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

  void check_rule(const json& owner, const std::string& owner_place, const SchemaRule& rule) const {
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

  void check_value(const json& value, const std::string& place, const SchemaRule& rule) const {
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
      if (rule.kind == JsonKind::objects && !value[i].is_object()) fail(element, "must be an object");
      if (rule.kind == JsonKind::texts && !value[i].is_string()) fail(element, "must be a string");
    }
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
  for (const SchemaGroup& group : schema_rules()) checker.check(group);
  const std::string version = document.at("asset").at("version").get<std::string>();
  const std::string minimum = document.at("asset").value("minVersion", version);
  if (!version.starts_with("2.")) checker.fail("asset.version", in_quotes(version) + " is not supported, only 2.x is");
  if (minimum != version && minimum != "2.0") {
    checker.fail("asset.minVersion", in_quotes(minimum) + " is not supported, only 2.0 is");
  }
  checker.check_channel_samplers();
  checker.check_camera_types();
  check_view_ranges(document, checker);
}

}  // namespace sheaf
