// SPDX-License-Identifier: MIT
#include "scene/gltf_extensions.hpp"

#include <algorithm>
#include <string_view>

#include "core/quote.hpp"

namespace sheaf {
namespace {

#ifdef SHEAF_HAS_DRACO
constexpr std::string_view draco_lacks;
#else
constexpr std::string_view draco_lacks = "libdraco";
#endif
#ifdef SHEAF_HAS_WEBP
constexpr std::string_view webp_lacks;
#else
constexpr std::string_view webp_lacks = "libwebp";
#endif

struct Extension {
  std::string_view name;
  std::string_view lacks = {};  // the library without which this build cannot read it
};

constexpr Extension readable[] = {
    {"KHR_materials_emissive_strength"},
    {"KHR_materials_unlit"},
    {"KHR_materials_transmission"},
    {"KHR_materials_ior"},
    {"KHR_materials_volume"},
    {"KHR_texture_transform"},
    {"KHR_lights_punctual"},
    {"KHR_mesh_quantization"},
    {"KHR_meshopt_compression"},
    {"EXT_meshopt_compression"},
    {"KHR_draco_mesh_compression", draco_lacks},
    {"EXT_mesh_gpu_instancing"},
    {"EXT_texture_webp", webp_lacks},
    {"KHR_materials_pbrSpecularGlossiness"},
    {"KHR_materials_variants"},
    {"KHR_node_visibility"},
    {"KHR_texture_basisu"},
    {"MSFT_lod"},
    {"MSFT_texture_dds"},
};

// Names that files use though no specification of the registry defines them (yet, or any more).
constexpr std::string_view drafts[] = {
    "KHR_materials_coat",
    "KHR_materials_fuzz",
    "KHR_materials_diffuse_roughness",
    "KHR_materials_volume_scatter",
    "KHR_materials_sss",
    "KHR_materials_subsurface",
    "KHR_materials_retroreflection",
    "KHR_texture_procedurals",
    "KHR_interactivity",
    "KHR_node_selectability",
    "KHR_node_hoverability",
    "KHR_audio_emitter",
    "KHR_gaussian_splatting",
    "KHR_physics_rigid_bodies",
    "EXT_texture_procedurals_mx_1_39",
};

// Why an extension is not read; empty where it is.
std::string fault_of(std::string_view name) {
  const auto* const found = std::ranges::find(readable, name, &Extension::name);
  if (found == std::end(readable))
    return std::ranges::count(drafts, name) > 0 ? "is a draft, which is not supported" : "is not supported";
  if (found->lacks.empty()) return {};
  return "is not supported: this build lacks " + std::string(found->lacks);
}

}  // namespace

bool reads_extension(std::string_view name) { return fault_of(name).empty(); }

void check_extensions(GltfFile& file) {
  if (const nlohmann::json* required = member(file.json, "extensionsRequired")) {
    for (const auto& entry : *required) {
      const auto name = entry.get<std::string>();
      if (const std::string fault = fault_of(name); !fault.empty())
        file.fail("extensionsRequired", in_quotes(name) + " " + fault);
    }
  }
  const nlohmann::json* used = member(file.json, "extensionsUsed");
  if (used == nullptr) return;
  for (const auto& entry : *used) {
    const auto name = entry.get<std::string>();
    const std::string fault = fault_of(name);
    std::vector<std::string>& list = fault.empty() ? file.extensions_read : file.extensions_ignored;
    if (std::ranges::count(list, name) > 0) continue;
    list.push_back(name);
    if (!fault.empty()) file.warn("extensionsUsed", in_quotes(name) + " " + fault + " and is ignored");
  }
}

}  // namespace sheaf
