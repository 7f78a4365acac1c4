// SPDX-License-Identifier: MIT
#include "scene/gltf_material.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <type_traits>

#include "scene/gltf_extensions.hpp"
#include "scene/gltf_image.hpp"
#include "scene/gltf_spec_gloss.hpp"

namespace sheaf {
namespace {

using nlohmann::json;

// A factor outside its range is brought into it with a warning: renderers do that silently, authors want to know. What
// a writer's rounding adds is no fault of the author's.
float clamped(GltfFile& file, const std::string& place, double value, double lo, double hi) {
  constexpr double rounding = 1e-6;
  const double inside = std::clamp(value, lo, hi);
  if (std::abs(inside - value) > rounding) {
    file.warn(place, std::to_string(value) + " is outside its range, " + std::to_string(inside) + " is used");
  }
  return static_cast<float>(inside);
}

class MaterialReader {
 public:
  MaterialReader(GltfFile& file, Scene& scene) : file_(file), scene_(scene) {}

  Material read(std::size_t index) {
    const tinygltf::Material& source = file_.model.materials[index];
    const json& object = file_.json["materials"][index];
    place_ = at("materials", index);
    file_.require("materials", index);
    Material out;
    out.name = source.name;
    const json* const spec_gloss = extension(object, spec_gloss_);
    if (spec_gloss != nullptr) {
      json rest = object;  // the extension's values hold, whatever stands beside it for readers that lack it
      rest.erase(pbr_);
      read_table(rest, out);
      read_spec_gloss(index, *spec_gloss, out);
    } else {
      read_table(object, out);
    }
    read_surface(source, out);
    read_extensions(object, out);
    return out;
  }

  // Only images that a material reads are decoded; Scene::images follows the order of their first use.
  void decode_used_images() {
    scene_.images = decode_images(file_, image_order_);
    convert_spec_gloss(file_, spec_gloss_materials_, scene_);
  }

 private:
  // The object that a line of the table names as its owner; null where the file has none.
  static const json* owner_of(const json& material, std::string_view owner) {
    if (owner == "material") return &material;
    if (owner == pbr_) return member(material, pbr_);
    return extension(material, owner.data());
  }

  // How messages name a property: those of extensions stand beside the material's own.
  [[nodiscard]] std::string place_of(std::string_view owner, const char* key) const {
    return place_ + (owner == pbr_ ? std::string(".") + pbr_ : "") + "." + key;
  }

  // Parameters and textures as the table has them; what a file does not give keeps its default.
  void read_table(const json& object, Material& out) {
#define SHEAF_FACTOR(type, words, field, value, owner, key, low, high) \
  read_factor(object, #owner, #key, {low, high}, out.field);
#define SHEAF_TEXTURE(number, place, field, owner, key, content) \
  if (const json* from = owner_of(object, #owner)) out.field = texture_use(*from, #key);
    MATERIAL_FACTORS(SHEAF_FACTOR)
    MATERIAL_TEXTURES(SHEAF_TEXTURE)
#undef SHEAF_FACTOR
#undef SHEAF_TEXTURE
  }

  struct Range {
    double low, high;
  };

  // A number, or one for each component. KHR_materials_volume's, which the table does not have, are read by this too.
  template <typename Factor>
  void read_factor(const json& object, std::string_view owner, const char* key, Range range, Factor& out) {
    const json* from = owner_of(object, owner);
    const json* value = from != nullptr ? member(*from, key) : nullptr;
    if (value == nullptr) return;
    const auto read = [&](const json& number) {
      return clamped(file_, place_of(owner, key), meant(key, number.get<double>()), range.low, range.high);
    };
    if constexpr (std::is_same_v<Factor, float>)
      out = read(*value);
    else
      for (int c = 0; c < Factor::length(); ++c) out[c] = read((*value)[static_cast<std::size_t>(c)]);
  }

  void read_spec_gloss(std::size_t index, const json& e, Material& out) {
    SpecGlossMaterial material{
        index, {}, texture_use(e, "diffuseTexture"), texture_use(e, "specularGlossinessTexture")};
    const auto read = [&](const char* key, const json& value) {
      return clamped(file_, place_ + "." + key, value.get<double>(), 0, 1);
    };
    const auto components = [&](const char* key, auto& factor) {
      if (const json* values = member(e, key))
        for (int c = 0; c < factor.length(); ++c) factor[c] = read(key, (*values)[static_cast<std::size_t>(c)]);
    };
    components("diffuseFactor", material.factors.diffuse);
    components("specularFactor", material.factors.specular);
    if (const json* value = member(e, "glossinessFactor"))
      material.factors.glossiness = read("glossinessFactor", *value);
    if (material.diffuse.present() || material.specular_glossiness.present()) {
      spec_gloss_materials_.push_back(material);
    } else {
      const MetalRough surface = to_metal_rough(material.factors);
      out.base_color = surface.base_color;
      out.metallic = surface.metallic;
      out.roughness = surface.roughness;
    }
  }

  // KHR_materials_ior gives 0 the meaning of an infinite index, where everything is mirrored. 1000 comes within 0.4 %
  // of that (F0 = (999 / 1001)^2) and keeps every formula finite.
  static double meant(std::string_view key, double value) { return key == "ior" && value == 0 ? 1000 : value; }

  void read_surface(const tinygltf::Material& source, Material& out) {
    out.normal_texture.strength = static_cast<float>(source.normalTexture.scale);
    out.occlusion_texture.strength =
        clamped(file_, place_ + ".occlusionTexture.strength", source.occlusionTexture.strength, 0, 1);
    if (source.alphaMode == "MASK") {
      out.alpha_mode = AlphaMode::mask;
    } else if (source.alphaMode == "BLEND") {
      out.alpha_mode = AlphaMode::blend;
    } else if (source.alphaMode != "OPAQUE") {
      file_.fail(place_ + ".alphaMode", in_quotes(source.alphaMode) + " is not OPAQUE, MASK or BLEND");
    }
    out.double_sided = source.doubleSided;
  }

  void read_extensions(const json& object, Material& out) {
    out.unlit = extension(object, "KHR_materials_unlit") != nullptr;
    if (const json* levels = extension(object, "MSFT_lod"))
      file_.warn(place_ + ".MSFT_lod",
                 "the finest of " + std::to_string(levels->at("ids").size() + 1) + " levels of detail is drawn");
    if (const json* e = extension(object, "KHR_materials_emissive_strength")) {
      const float strength =
          clamped(file_, place_ + ".emissiveStrength", number_or(*e, "emissiveStrength", 1), 0, any_);
      out.emissive *= strength;
      if (!std::isfinite(out.emissive.x + out.emissive.y + out.emissive.z))
        file_.fail(place_ + ".emissiveStrength", "is too large");
    }
    if (const json* e = extension(object, "KHR_materials_volume")) read_volume(object, *e, out);
  }

  void read_volume(const json& object, const json& e, Material& out) {
    read_factor(object, "KHR_materials_volume", "thicknessFactor", {0, any_}, out.thickness);
    read_factor(object, "KHR_materials_volume", "attenuationColor", {0, 1}, out.attenuation_color);
    if (e.contains("thicknessTexture")) {
      file_.warn(place_ + ".thicknessTexture", "is ignored: absorption follows the path through the closed mesh");
    }
    if (e.contains("attenuationDistance")) {
      const double distance = number_or(e, "attenuationDistance", 0);
      if (distance < 0) file_.fail(place_ + ".attenuationDistance", "must be larger than 0");
      if (distance == 0) {
        file_.warn(place_ + ".attenuationDistance", "is 0, taken as infinite");
      } else {
        out.attenuation_distance = static_cast<float>(distance);
      }
    }
  }

  TextureUse texture_use(const json& owner, const char* slot) {
    TextureUse use;
    const json* info = member(owner, slot);
    if (!info) return use;
    use.texture = texture(info->at("index").get<std::uint32_t>());
    use.uv_set = static_cast<std::uint32_t>(number_or(*info, "texCoord", 0));
    if (const json* e = extension(*info, "KHR_texture_transform")) read_transform(*e, use);
    if (use.present() && use.uv_set > 1) {
      file_.warn(place_ + "." + slot, "reads TEXCOORD_" + std::to_string(use.uv_set) +
                                          ", only sets 0 and 1 are supported: the texture is ignored");
      return {};
    }
    return use;
  }

  static void read_transform(const json& e, TextureUse& use) {
    const auto pair = [&](const char* key, glm::vec2& out) {
      if (const json* v = member(e, key)) out = glm::vec2((*v)[0].get<float>(), (*v)[1].get<float>());
    };
    pair("offset", use.offset);
    pair("scale", use.scale);
    use.rotation = static_cast<float>(number_or(e, "rotation", 0));
    use.uv_set = static_cast<std::uint32_t>(number_or(e, "texCoord", use.uv_set));
  }

  // Scene::textures holds those that are used, in the order of their first use.
  std::uint32_t texture(std::uint32_t index) {
    const auto [known, is_new] = textures_.try_emplace(index, none);
    if (!is_new) return known->second;
    file_.require("textures", index);
    const tinygltf::Texture& source = file_.model.textures[index];
    const std::uint32_t read = image_of(index);
    if (read == none) {
      file_.warn(at("textures", index), "has no image that can be read and is ignored");
      return none;
    }
    Texture out;
    const auto [image, fresh] = images_.try_emplace(read, static_cast<std::uint32_t>(image_order_.size()));
    if (fresh) image_order_.push_back(read);
    out.image = image->second;
    if (source.sampler >= 0) read_sampler(static_cast<std::size_t>(source.sampler), out);
    known->second = static_cast<std::uint32_t>(scene_.textures.size());
    scene_.textures.push_back(out);
    return known->second;
  }

  // That of an extension before the texture's own, which is there for readers that lack the extension.
  [[nodiscard]] std::uint32_t image_of(std::size_t index) const {
    const json& texture = file_.json["textures"][index];
    for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "MSFT_texture_dds"}) {
      const json* source = reads_extension(name) ? extension(texture, name) : nullptr;
      if (source != nullptr) source = member(*source, "source");
      if (source != nullptr) return source->get<std::uint32_t>();
    }
    const int own = file_.model.textures[index].source;
    return own < 0 ? none : static_cast<std::uint32_t>(own);
  }

  void read_sampler(std::size_t index, Texture& out) const {
    file_.require("samplers", index);
    const tinygltf::Sampler& sampler = file_.model.samplers[index];
    const auto wrap = [&](int mode, const char* key) {
      if (mode == TINYGLTF_TEXTURE_WRAP_REPEAT) return Wrap::repeat;
      if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::mirrored_repeat;
      if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp_to_edge;
      file_.fail(at("samplers", index) + "." + key, std::to_string(mode) + " is not a wrap mode");
    };
    out.wrap_s = wrap(sampler.wrapS, "wrapS");
    out.wrap_t = wrap(sampler.wrapT, "wrapT");
    out.nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    out.mipmapped =
        sampler.minFilter != TINYGLTF_TEXTURE_FILTER_NEAREST && sampler.minFilter != TINYGLTF_TEXTURE_FILTER_LINEAR;
  }

  static constexpr const char* pbr_ = "pbrMetallicRoughness";
  static constexpr const char* spec_gloss_ = "KHR_materials_pbrSpecularGlossiness";
  static constexpr double any_ = std::numeric_limits<float>::max();
  GltfFile& file_;
  Scene& scene_;
  std::string place_;
  std::map<std::uint32_t, std::uint32_t> textures_, images_;  // index in the file to index in the scene
  std::vector<std::uint32_t> image_order_;
  std::vector<SpecGlossMaterial> spec_gloss_materials_;
};

}  // namespace

void load_materials(GltfFile& file, const std::vector<bool>& used, Scene& scene) {
  MaterialReader reader(file, scene);
  for (std::size_t i = 0; i < used.size(); ++i) {
    scene.materials.push_back(used[i] ? reader.read(i) : Material{});
    scene.materials.back().name = file.model.materials[i].name;
  }
  scene.materials.emplace_back();
  scene.materials.back().name = "default";
  reader.decode_used_images();
}

}  // namespace sheaf
