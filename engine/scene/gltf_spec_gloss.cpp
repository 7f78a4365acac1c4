// SPDX-License-Identifier: MIT
#include "scene/gltf_spec_gloss.hpp"

#include <map>
#include <utility>

namespace sheaf {
namespace {

bool same_places(const TextureUse& a, const TextureUse& b, const Scene& scene) {
  const Texture &s = scene.textures[a.texture], &t = scene.textures[b.texture];
  return a.uv_set == b.uv_set && a.offset == b.offset && a.scale == b.scale && a.rotation == b.rotation &&
         s.wrap_s == t.wrap_s && s.wrap_t == t.wrap_t;
}

// One texel: the mean, of what is stored.
Image mean_of(const Image& image) {
  std::array<std::uint64_t, 4> sum{};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) sum[i % 4] += image.rgba[i];
  Image mean{image.name, 1, 1, {}};
  for (const std::uint64_t s : sum) mean.rgba.push_back(static_cast<std::uint8_t>(s * 4 / image.rgba.size()));
  return mean;
}

class Converter {
 public:
  Converter(const GltfFile& file, Scene& scene) : file_(file), scene_(scene) {
    for (const Image& image : scene_.images) bytes_ += image.rgba.size();
  }

  void convert(const SpecGlossMaterial& from) {
    const Image* diffuse = image_of(from.diffuse);
    const Image* specular_glossiness = image_of(from.specular_glossiness);
    Image mean;
    if (diffuse != nullptr && specular_glossiness != nullptr &&
        !same_places(from.diffuse, from.specular_glossiness, scene_)) {
      file_.warn(at("materials", from.material) + ".specularGlossinessTexture",
                 "lies elsewhere than diffuseTexture: its mean is used");
      mean = mean_of(*specular_glossiness);
      specular_glossiness = &mean;
    }
    const Image* const larger = diffuse != nullptr ? diffuse : specular_glossiness;
    bytes_ += 2 * 4 * std::uint64_t{larger->width} * larger->height;
    if (bytes_ > file_.limits.texture_bytes)
      file_.over_limit(at("materials", from.material),
                       "the converted images exceed " + std::to_string(file_.limits.texture_bytes) + " bytes");
    MetalRoughImages images = to_metal_rough(from.factors, diffuse, specular_glossiness);
    const TextureUse& use = diffuse != nullptr ? from.diffuse : from.specular_glossiness;
    Material& material = scene_.materials[from.material];
    material.base_color_texture = add(std::move(images.base_color), use);
    material.metallic_roughness_texture = add(std::move(images.metallic_roughness), use);
  }

 private:
  [[nodiscard]] const Image* image_of(const TextureUse& use) const {
    return use.present() ? &scene_.images[scene_.textures[use.texture].image] : nullptr;
  }

  TextureUse add(Image image, TextureUse use) {
    Texture texture = scene_.textures[use.texture];
    texture.image = static_cast<std::uint32_t>(scene_.images.size());
    scene_.images.push_back(std::move(image));
    use.texture = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.push_back(texture);
    return use;
  }

  const GltfFile& file_;
  Scene& scene_;
  std::uint64_t bytes_ = 0;
};

// The number that `old` has among those that are kept.
std::uint32_t kept(std::uint32_t old, std::map<std::uint32_t, std::uint32_t>& numbers) {
  return numbers.try_emplace(old, static_cast<std::uint32_t>(numbers.size())).first->second;
}

void drop_unused(Scene& scene) {
  std::map<std::uint32_t, std::uint32_t> texture_numbers, image_numbers;
  for (Material& material : scene.materials) {
    for_each_texture(material, [&](TextureUse& use, auto...) {
      if (use.present()) use.texture = kept(use.texture, texture_numbers);
    });
  }
  std::vector<Texture> textures(texture_numbers.size());
  for (const auto& [old, number] : texture_numbers) textures[number] = scene.textures[old];
  for (Texture& texture : textures) texture.image = kept(texture.image, image_numbers);
  std::vector<Image> images(image_numbers.size());
  for (const auto& [old, number] : image_numbers) images[number] = std::move(scene.images[old]);
  scene.textures = std::move(textures);
  scene.images = std::move(images);
}

}  // namespace

void convert_spec_gloss(const GltfFile& file, const std::vector<SpecGlossMaterial>& materials, Scene& scene) {
  if (materials.empty()) return;
  Converter converter(file, scene);
  for (const SpecGlossMaterial& material : materials) converter.convert(material);
  drop_unused(scene);
}

}  // namespace sheaf
