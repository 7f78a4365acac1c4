// SPDX-License-Identifier: MIT
#include "frame/material_layout.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "core/error.hpp"
#include "frame/scene_layout.hpp"

namespace sheaf {
namespace {

constexpr std::size_t max_volumes = 255;  // a byte of a ray's medium stack

gpu::TextureUse lay_out_use(const TextureUse& use) {
  return {use.offset, use.scale, use.rotation, use.strength, use.texture, use.uv_set};
}

// Stops (powers of two) of absorption a metre: color^(t/distance) = 2^(−stops·t).
glm::vec3 absorption(const Material& material) {
  glm::vec3 stops(0);
  if (!(material.attenuation_distance < std::numeric_limits<float>::infinity()) || material.attenuation_distance <= 0)
    return stops;
  for (int c = 0; c < 3; ++c)
    stops[c] = -std::log2(std::clamp(material.attenuation_color[c], 1e-9F, 1.0F)) / material.attenuation_distance;
  return stops;
}

bool is_volume(const Material& material, const RenderSettings& settings) {
  return material.transmission > 0 && material.thickness > 0 && !material.unlit && !settings.opaque;
}

std::uint32_t flags_of(const Material& material, const RenderSettings& settings) {
  std::uint32_t flags = material.unlit ? gpu::MATERIAL_UNLIT : 0;
  if (settings.opaque) return flags;
  if (material.alpha_mode == AlphaMode::mask) flags |= gpu::MATERIAL_MASK;
  if (material.alpha_mode == AlphaMode::blend) flags |= gpu::MATERIAL_BLEND;
  if (material.transmission > 0) flags |= gpu::MATERIAL_TRANSMISSIVE;
  if (is_volume(material, settings)) flags |= gpu::MATERIAL_VOLUME;
  return flags;
}

gpu::Material lay_out_material(const Material& m, const RenderSettings& settings) {
  gpu::Material g{};
  g.base_color = m.base_color;
  g.emissive = m.emissive;
  g.metallic = m.metallic;
  g.roughness = m.roughness;
  g.alpha_cutoff = m.alpha_cutoff;
  g.transmission = settings.opaque ? 0 : m.transmission;
  g.ior = m.ior;
  g.absorption = absorption(m);
  g.flags = flags_of(m, settings);
  g.base_color_texture = lay_out_use(m.base_color_texture);
  g.metallic_roughness_texture = lay_out_use(m.metallic_roughness_texture);
  g.normal_texture = lay_out_use(m.normal_texture);
  g.occlusion_texture = lay_out_use(m.occlusion_texture);
  g.emissive_texture = lay_out_use(m.emissive_texture);
  g.transmission_texture = lay_out_use(m.transmission_texture);
  return g;
}

void lay_out_textures(const Scene& scene, SceneLayout& layout) {
  std::vector<std::uint32_t> first;
  for (const auto& image : scene.images) {
    first.push_back(static_cast<std::uint32_t>(layout.texels.size()));
    const std::size_t texels = image.rgba.size() / 4, at = layout.texels.size();
    layout.texels.resize(at + texels);
    if (texels != 0) std::memcpy(&layout.texels[at], image.rgba.data(), texels * 4);
  }
  for (const auto& texture : scene.textures) {
    gpu::Texture t{};
    if (texture.image != none) {
      t.first_texel = first[texture.image];
      t.width = scene.images[texture.image].width;
      t.height = scene.images[texture.image].height;
    }
    t.flags = static_cast<std::uint32_t>(texture.wrap_s) | static_cast<std::uint32_t>(texture.wrap_t) << 2U |
              (texture.nearest ? 16U : 0U);
    layout.textures.push_back(t);
  }
}

}  // namespace

std::vector<std::uint32_t> lay_out_materials(const Scene& scene, const RenderSettings& settings, SceneLayout& layout) {
  std::vector<std::uint32_t> by_place(scene.materials.size());
  std::iota(by_place.begin(), by_place.end(), 0U);
  const auto volumes = std::stable_partition(by_place.begin(), by_place.end(),
                                             [&](auto m) { return is_volume(scene.materials[m], settings); });
  const auto volume_count = static_cast<std::size_t>(volumes - by_place.begin());
  if (volume_count > max_volumes) throw limit_error(scene.path, "more than 255 materials with a volume");
  std::vector<std::uint32_t> place(scene.materials.size());
  for (std::uint32_t p = 0; p < by_place.size(); ++p) {
    place[by_place[p]] = p;
    auto material = lay_out_material(scene.materials[by_place[p]], settings);
    material.volume = p < volume_count ? p + 1 : 0;
    material.id = by_place[p] + 1;
    layout.materials.push_back(material);
  }
  lay_out_textures(scene, layout);
  // A texture without an image reads as none.
  for (auto& material : layout.materials)
    for (auto* use : {&material.base_color_texture, &material.metallic_roughness_texture, &material.normal_texture,
                      &material.occlusion_texture, &material.emissive_texture, &material.transmission_texture})
      if (use->texture != none && layout.textures[use->texture].width == 0) use->texture = none;
  return place;
}

}  // namespace sheaf
