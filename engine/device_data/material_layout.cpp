// SPDX-License-Identifier: MIT
#include "device_data/material_layout.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/error.hpp"
#include "device_data/mip_levels.hpp"
#include "device_data/scene_layout.hpp"

namespace sheaf {
namespace {

constexpr std::size_t max_volumes = 255;  // a byte of a ray's medium stack

// Lays out each image that is used, once for each way its levels are made.
class Images {
 public:
  Images(const Scene& scene, std::vector<std::uint32_t>& texels) : scene_(scene), texels_(texels) {}

  std::uint32_t first_texel(std::uint32_t image, MipContent content, std::uint32_t levels) {
    const auto [at, is_new] = first_.try_emplace({image, content, levels}, static_cast<std::uint32_t>(texels_.size()));
    if (is_new) append_mip_levels(scene_.images[image], content, levels, texels_);
    if (texels_.size() > max_texels) throw limit_error(scene_.path, "more than 2^30 texels");
    return at->second;
  }

 private:
  static constexpr std::size_t max_texels = std::size_t{1} << 30U;  // byte offsets into them fit 32 bits
  const Scene& scene_;
  std::vector<std::uint32_t>& texels_;
  std::map<std::tuple<std::uint32_t, MipContent, std::uint32_t>, std::uint32_t> first_;
};

// A texture without an image reads as none.
gpu::TextureUse lay_out_use(const Scene& scene, Images& images, const TextureUse& use, MipContent content) {
  gpu::TextureUse g{};
  g.strength = use.strength;
  if (!use.present()) return g;
  const Texture& texture = scene.textures[use.texture];
  if (texture.image == none || scene.images[texture.image].width == 0) return g;
  g.offset = use.offset;
  g.scale = use.scale;
  g.turn = {static_cast<float>(std::cos(double{use.rotation})), static_cast<float>(std::sin(double{use.rotation}))};
  g.width = scene.images[texture.image].width;
  g.height = scene.images[texture.image].height;
  g.levels = texture.mipmapped ? static_cast<std::uint32_t>(std::bit_width(std::max(g.width, g.height))) : 1;
  g.first_texel = images.first_texel(texture.image, content, g.levels);
  g.flags = static_cast<std::uint32_t>(texture.wrap_s) | static_cast<std::uint32_t>(texture.wrap_t) << 2U |
            (texture.nearest ? gpu::TEXTURE_NEAREST : 0) | (use.uv_set == 1 ? gpu::TEXTURE_UV1 : 0) | gpu::TEXTURE_HERE;
  return g;
}

// Stops (powers of two) of absorption per metre: color^(t/distance) = 2^(−stops·t). A color of 0 lets nothing through
// at any distance: ABSORBS_ALL.
glm::vec3 absorption(const Material& material) {
  glm::vec3 stops(0);
  if (!(material.attenuation_distance < std::numeric_limits<float>::infinity()) || material.attenuation_distance <= 0)
    return stops;
  for (int c = 0; c < 3; ++c) {
    const double color = std::min(material.attenuation_color[c], 1.0F);
    const double exact = color > 0 ? -std::log2(color) / double{material.attenuation_distance} : gpu::ABSORBS_ALL;
    stops[c] = static_cast<float>(std::min<double>(exact, gpu::ABSORBS_ALL));
  }
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
  if (material.transmission > 0 && !material.unlit) flags |= gpu::MATERIAL_TRANSMISSIVE;
  if (hides_back(settings, material)) flags |= gpu::MATERIAL_ONE_SIDED;
  if (is_volume(material, settings)) flags |= gpu::MATERIAL_VOLUME;
  return flags;
}

gpu::Material lay_out_material(const Scene& scene, Images& images, const Material& m, const RenderSettings& settings) {
  gpu::Material g{};
#define SHEAF_FACTOR(type, words, field, value, owner, key, low, high) g.field = m.field;
  MATERIAL_FACTORS(SHEAF_FACTOR)
#undef SHEAF_FACTOR
  if (settings.opaque || m.unlit) g.transmission = 0;
  g.absorption = absorption(m);
  g.flags = flags_of(m, settings);
  const bool see_through = m.alpha_mode != AlphaMode::opaque && !settings.opaque;
  const auto base = see_through ? MipContent::color_by_alpha : MipContent::color;
  for_each_texture(m, [&](const TextureUse& use, std::uint32_t place, std::uint32_t content) {
    const auto kind = content == CONTENT_COLOR ? MipContent::color : MipContent::data;
    g.uses[place] = lay_out_use(scene, images, use, place == gpu::TEXTURE_BASE_COLOR ? base : kind);
  });
  return g;
}

}  // namespace

std::vector<std::uint32_t> lay_out_materials(const Scene& scene, const RenderSettings& settings, SceneLayout& layout) {
  std::vector<std::uint32_t> by_place(scene.materials.size());
  std::iota(by_place.begin(), by_place.end(), 0U);
  const auto volumes = std::stable_partition(by_place.begin(), by_place.end(),
                                             [&](auto m) { return is_volume(scene.materials[m], settings); });
  const auto volume_count = static_cast<std::size_t>(volumes - by_place.begin());
  if (volume_count > max_volumes) throw limit_error(scene.path, "more than 255 materials with a volume");
  Images images(scene, layout.texels);
  std::vector<std::uint32_t> place(scene.materials.size());
  for (std::uint32_t p = 0; p < by_place.size(); ++p) {
    place[by_place[p]] = p;
    auto material = lay_out_material(scene, images, scene.materials[by_place[p]], settings);
    material.volume = p < volume_count ? p + 1 : 0;
    material.id = by_place[p] + 1;
    layout.materials.push_back(material);
  }
  return place;
}

}  // namespace sheaf
