// SPDX-License-Identifier: MIT
// KHR_materials_pbrSpecularGlossiness: what scatters and what mirrors stay what they were.
#include <cmath>

#include "gltf_support.hpp"
#include "scene/spec_gloss.hpp"

namespace sheaf {
namespace {

using namespace test;
using nlohmann::json;

// Diffuse light and reflectance of a metallic-roughness material, which is a mixture of a dielectric and a metal.
glm::dvec3 scattered(const MetalRough& m) { return glm::dvec3(m.base_color) * (0.96 * (1 - m.metallic)); }
glm::dvec3 mirrored(const MetalRough& m) {
  return glm::mix(glm::dvec3(0.04), glm::dvec3(m.base_color), double{m.metallic});
}

TEST(SpecGloss, DielectricsAndMetalsAreExact) {
  const MetalRough plastic = to_metal_rough({{0.8f, 0.1f, 0.3f, 0.5f}, glm::vec3(0.04f), 0.75f});
  EXPECT_EQ(plastic.metallic, 0);
  EXPECT_FLOAT_EQ(plastic.roughness, 0.25f);
  expect_near(glm::dvec3(plastic.base_color), {0.8, 0.1, 0.3});
  EXPECT_EQ(plastic.base_color.a, 0.5f);
  const MetalRough gold = to_metal_rough({{0, 0, 0, 1}, {1, 0.766f, 0.336f}, 0.9f});
  EXPECT_NEAR(gold.metallic, 1, 1e-6);
  expect_near(glm::dvec3(gold.base_color), {1, 0.766, 0.336}, 1e-5);
}

TEST(SpecGloss, GreysBetweenThemScatterAndMirrorAsBefore) {
  for (const float diffuse : {0.1f, 0.5f, 1.0f}) {
    for (const float specular : {0.04f, 0.1f, 0.3f, 0.6f, 0.9f}) {
      const MetalRough m = to_metal_rough({glm::vec4(glm::vec3(diffuse), 1), glm::vec3(specular), 0});
      EXPECT_NEAR(scattered(m).g, diffuse * (1 - specular), 0.06) << diffuse << " " << specular;
      EXPECT_NEAR(mirrored(m).g, specular, 0.06) << diffuse << " " << specular;
    }
  }
}

TEST(SpecGloss, TexelsAreConvertedOneByOneInTheLargerSize) {
  // Left gold, right red plastic of half the gloss; diffuse is black and red, in an image of twice the height.
  const Image spec_gloss{"s", 2, 1, {255, 226, 157, 255, 56, 56, 56, 128}};
  const Image diffuse{"d", 2, 2, {0, 0, 0, 255, 188, 0, 0, 64, 0, 0, 0, 255, 188, 0, 0, 64}};
  const MetalRoughImages out = to_metal_rough({}, &diffuse, &spec_gloss);
  EXPECT_EQ(out.base_color.width, 2u);
  EXPECT_EQ(out.base_color.height, 2u);
  const auto near = [](const Image& image, std::size_t texel, std::array<int, 4> expected) {
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(image.rgba[4 * texel + c], expected[c], 1) << texel << " " << c;
  };
  for (const std::size_t row : {0, 2}) {
    near(out.base_color, row, {255, 226, 157, 255});
    near(out.metallic_roughness, row, {0, 0, 255, 255});
    near(out.base_color, row + 1, {188, 0, 0, 64});
    near(out.metallic_roughness, row + 1, {0, 127, 0, 255});
  }
}

TEST(SpecGloss, FactorsMultiplyTexels) {
  const Image diffuse{"d", 1, 1, {188, 188, 188, 128}};  // 0.5 in linear light
  const MetalRoughImages out = to_metal_rough({{0.5f, 1, 1, 0.5f}, glm::vec3(0.04f), 0.2f}, &diffuse, nullptr);
  EXPECT_NEAR(out.base_color.rgba[0], 137, 1) << "0.25 in linear light";
  EXPECT_NEAR(out.base_color.rgba[1], 188, 1);
  EXPECT_NEAR(out.base_color.rgba[3], 64, 1);
  EXPECT_NEAR(out.metallic_roughness.rgba[1], 204, 1);
}

// A PNG of one white texel.
constexpr const char* white_png =
    "data:image/"
    "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAG7buVgAAAABJRU5ErkJggg==";

TEST(SpecGloss, ReplacesTheMaterialsOtherModel) {
  GltfBuilder b = whole_document();
  b.add("images", {{"uri", white_png}});
  b.add("images", {{"uri", "absent.png"}});
  for (int i = 0; i < 2; ++i) b.add("textures", {{"source", i}});
  const json spec_gloss = {{"diffuseFactor", {0.25, 0.5, 1, 1}},
                           {"specularFactor", {0.04, 0.04, 0.04}},
                           {"diffuseTexture", {{"index", 0}, {"texCoord", 1}}}};
  b.doc["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 1}}}, {"metallicFactor", 0.3}}},
                         {"extensions", {{"KHR_materials_pbrSpecularGlossiness", spec_gloss}}}}};
  b.doc["meshes"][0]["primitives"][0]["material"] = 0;
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
  Scene scene = load(b);
  ASSERT_EQ(scene.images.size(), 2u) << "the two that were made, and none that nothing uses";
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.base_color_texture.uv_set, 1u);
  EXPECT_EQ(scene.images[scene.textures[material.base_color_texture.texture].image].rgba,
            (std::vector<std::uint8_t>{137, 188, 255, 255}));
  EXPECT_EQ(scene.images[scene.textures[material.metallic_roughness_texture.texture].image].rgba,
            (std::vector<std::uint8_t>{0, 0, 0, 255}));
  EXPECT_EQ(material.metallic, 1) << "textures hold the factors";

  auto& changed = b.doc["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"];
  changed["specularGlossinessTexture"] = {{"index", 0}};
  scene = load(b);
  EXPECT_TRUE(warns(scene, "materials[0].specularGlossinessTexture: lies elsewhere than diffuseTexture"));
  changed = {{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {1, 0.5, 0.25}}, {"glossinessFactor", 0.75}};
  scene = load(b);
  EXPECT_TRUE(scene.images.empty());
  EXPECT_NEAR(scene.materials[0].metallic, 1, 1e-6);
  EXPECT_FLOAT_EQ(scene.materials[0].roughness, 0.25f);
  EXPECT_NEAR(scene.materials[0].base_color.g, 0.5, 1e-6);
}

}  // namespace
}  // namespace sheaf
