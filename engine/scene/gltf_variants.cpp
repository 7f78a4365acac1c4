// SPDX-License-Identifier: MIT
#include "scene/gltf_variants.hpp"

#include <algorithm>

namespace sheaf {
namespace {

using nlohmann::json;

constexpr const char* variants_name = "KHR_materials_variants";

std::uint32_t chosen_variant(const GltfFile& file, const std::vector<std::string>& names, const std::string& selector) {
  const auto found = std::ranges::find(names, selector);
  if (found != names.end()) return static_cast<std::uint32_t>(found - names.begin());
  const bool digits =
      selector.size() <= 9 && std::ranges::all_of(selector, [](char c) { return c >= '0' && c <= '9'; });
  if (digits && std::stoul(selector) < names.size()) return static_cast<std::uint32_t>(std::stoul(selector));
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? ": " : ", ") + in_quotes(name, 60);
  file.fail("variants",
            "there is no variant " + in_quotes(selector) + " among " + std::to_string(names.size()) + known);
}

bool maps(const json& mapping, std::uint32_t variant) {
  const json* variants = member(mapping, "variants");
  if (variants == nullptr) return false;
  return std::ranges::any_of(*variants, [&](const json& index) { return index.get<double>() == variant; });
}

}  // namespace

std::vector<std::string> variant_names(const GltfFile& file) {
  std::vector<std::string> names;
  const json* const variants = extension(file.json, variants_name);
  if (variants == nullptr) return names;
  for (const json& variant : variants->at("variants")) {
    const json* name = member(variant, "name");
    names.push_back(name != nullptr && name->is_string() ? name->get<std::string>() : "");
  }
  return names;
}

void choose_variant(GltfFile& file, const std::string& selector) {
  if (selector.empty()) return;
  const std::uint32_t variant = chosen_variant(file, variant_names(file), selector);
  for (std::size_t m = 0; m < file.model.meshes.size(); ++m) {
    std::vector<tinygltf::Primitive>& primitives = file.model.meshes[m].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const json* const mapped = extension(file.json["meshes"][m]["primitives"][p], variants_name);
      if (mapped == nullptr) continue;
      const json& mappings = mapped->at("mappings");
      const auto found = std::ranges::find_if(mappings, [&](const json& one) { return maps(one, variant); });
      if (found != mappings.end()) primitives[p].material = found->at("material").get<int>();
    }
  }
}

}  // namespace sheaf
