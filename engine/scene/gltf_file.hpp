// SPDX-License-Identifier: MIT
// One glTF file opened: its JSON checked against the rules below, then read by tinygltf. Everything that the rest of
// the loader needs from the file passes through here, so that no index, size or URI is used before it was checked.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "scene/gltf_loader.hpp"

namespace sheaf {

struct GltfFile {
  std::string path;
  LoadLimits limits;
  std::string sha256;
  nlohmann::json json;    // the same document as `model`: what tinygltf does not read (extensions) is read from here
  tinygltf::Model model;  // images hold their encoded bytes
  std::vector<std::string> warnings;
  std::vector<std::string> extensions_ignored;

  [[noreturn]] void fail(const std::string& place, const std::string& reason) const {
    throw input_error(path + ": " + place, reason);
  }
  [[noreturn]] void over_limit(const std::string& place, const std::string& reason) const {
    throw limit_error(path + ": " + place, reason);
  }
  void warn(const std::string& place, const std::string& reason) { warnings.push_back(place + ": " + reason); }
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
