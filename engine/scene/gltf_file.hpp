// SPDX-License-Identifier: MIT
// One glTF file opened. Its text is parsed once; that document is mended, checked against the schema's rules, and given
// to tinygltf for what it has a model of. Everything that the rest of the loader needs from the file passes through
// here, so that no index, size or URI is used before it was checked.
#pragma once

#include <tiny_gltf.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "scene/broken_objects.hpp"
#include "scene/gltf_bytes.hpp"
#include "scene/gltf_loader.hpp"
#include "scene/warning_list.hpp"

namespace sheaf {

struct GltfFile {
  std::string path;
  LoadLimits limits;
  nlohmann::json json;    // for extensions, and for what `model` does not have
  tinygltf::Model model;  // without buffers, bufferViews, images, cameras, animations and lights
  std::unique_ptr<GltfBytes> bytes;
  BrokenObjects broken;
  mutable WarningList warnings;
  std::vector<std::string> extensions_read, extensions_ignored;

  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw input_error(path + ": " + place, reason);
  }
  [[noreturn]] void over_limit(const std::string& place, const std::string& reason) const {
    throw limit_error(path + ": " + place, reason);
  }
  void warn(const std::string& place, const std::string& reason) const { warnings.add(place, reason); }

  /// An error's text without the file's name: what `fail` was given.
  [[nodiscard]] Fault fault_of(std::string text) const {
    const std::string shown = one_line(bounded_words(path + ": "));
    if (text.starts_with(shown)) text.erase(0, shown.size());
    const std::size_t colon = std::min(text.find(": "), text.size());
    return {text.substr(0, colon), text.substr(std::min(colon + 2, text.size()))};
  }
  void warn_of(const std::string& error, const std::string& consequence) const {
    const Fault fault = fault_of(error);
    warn(fault.place, fault.reason + ": " + consequence);
  }

  /// Throws where the object is one of the broken ones. Whatever uses an object asks first.
  void require(const std::string& collection, std::size_t index) const {
    if (const Fault* fault = broken.find(collection, index)) fail(fault->place, fault->reason);
  }
  [[nodiscard]] std::size_t count(const char* collection) const {
    const auto found = json.find(collection);
    return found == json.end() ? 0 : found->size();
  }
};

[[nodiscard]] GltfFile open_gltf(const std::string& path, const LoadLimits& limits);

/// "nodes[3]"
[[nodiscard]] inline std::string at(const char* collection, std::size_t index) {
  return std::string(collection) + "[" + std::to_string(index) + "]";
}

/// The member, or null where `object` is none or lacks it.
[[nodiscard]] inline const nlohmann::json* member(const nlohmann::json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

/// object.extensions.NAME, or null.
[[nodiscard]] inline const nlohmann::json* extension(const nlohmann::json& object, const char* name) {
  const nlohmann::json* extensions = member(object, "extensions");
  return extensions ? member(*extensions, name) : nullptr;
}

[[nodiscard]] inline double number_or(const nlohmann::json& object, const char* key, double otherwise) {
  const nlohmann::json* value = member(object, key);
  return value && value->is_number() ? value->get<double>() : otherwise;
}

}  // namespace sheaf
