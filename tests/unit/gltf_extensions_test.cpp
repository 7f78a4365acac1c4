// SPDX-License-Identifier: MIT
// Extensions that choose among what a file holds, and what is said of those that are not read.
#include "core/error.hpp"
#include "gltf_support.hpp"

namespace sheaf {
namespace {

using namespace test;
using nlohmann::json;

std::string refusal(GltfBuilder& b, const SceneChoice& choice = {}) {
  const TempFolder folder;
  try {
    (void)load_gltf(folder.write("scene.gltf", b.text()), choice);
    return "was read";
  } catch (const Error& error) {
    return error.what();
  }
}

// A triangle of material 0, which becomes 1 in the variant "night" and 2 in the variants "dawn" and "dusk".
GltfBuilder with_variants() {
  GltfBuilder b;
  const auto mapping = [](int material, const json& variants) {
    return json{{"material", material}, {"variants", variants}};
  };
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}},
              {{"material", 0},
               {"extensions", {{"KHR_materials_variants", {{"mappings", {mapping(1, {1}), mapping(2, {0, 2})}}}}}}});
  for (const char* name : {"day", "moon", "sun"}) b.add("materials", {{"name", name}});
  b.doc["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "dawn"}}, {{"name", "night"}}, {{"name", "dusk"}}, {{"name", "rain"}}};
  b.doc["extensionsUsed"] = {"KHR_materials_variants"};
  return b;
}

std::string material_by(const std::string& variant) {
  GltfBuilder b = with_variants();
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()), {{}, variant});
  return scene.materials[scene.meshes.at(0).material].name;
}

TEST(GltfVariants, MapMaterialsByNameAndByIndex) {
  EXPECT_EQ(material_by(""), "day");
  EXPECT_EQ(material_by("night"), "moon");
  EXPECT_EQ(material_by("dusk"), "sun");
  EXPECT_EQ(material_by("0"), "sun");
  EXPECT_EQ(material_by("rain"), "day") << "no mapping has it";
  GltfBuilder b = with_variants();
  EXPECT_EQ(load(b).variants, (std::vector<std::string>{"dawn", "night", "dusk", "rain"}));
}

TEST(GltfVariants, AnUnknownOneIsRefusedWithThoseThereAre) {
  GltfBuilder b = with_variants();
  EXPECT_NE(
      refusal(b, {{}, "noon"}).find(R"(variants: there is no variant "noon" among 4: "dawn", "night", "dusk", "rain")"),
      std::string::npos)
      << refusal(b, {{}, "noon"});
  EXPECT_NE(refusal(b, {{}, "4"}).find("there is no variant \"4\""), std::string::npos);
  b.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][0]["material"] = 9;
  EXPECT_NE(refusal(b).find("mappings[0].material: 9 is out of range"), std::string::npos) << refusal(b);
}

TEST(GltfVisibility, HidesWhatHangsFromAHiddenNodeToo) {
  // 0 is hidden and has a mesh, a camera and the child 1, which says it is visible, with a mesh and a light.
  GltfBuilder b;
  const json attributes = {{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}};
  for (int i = 0; i < 3; ++i) b.node_with(attributes);
  const auto visible = [](bool is) { return json{{"visible", is}}; };
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.doc["nodes"][0].update(
      {{"children", {1}}, {"camera", 0}, {"extensions", {{"KHR_node_visibility", visible(false)}}}});
  b.doc["nodes"][1]["extensions"] = {{"KHR_node_visibility", visible(true)}, {"KHR_lights_punctual", {{"light", 0}}}};
  b.doc["nodes"][2]["extensions"] = {{"KHR_node_visibility", json::object()}};
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_node_visibility", "KHR_lights_punctual"};
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes.size(), 1u) << "meshes of hidden nodes are not read";
  EXPECT_EQ(scene.nodes[0].mesh_count, 0u);
  EXPECT_EQ(scene.nodes[1].mesh_count, 0u);
  EXPECT_EQ(scene.nodes[1].light, none);
  EXPECT_EQ(scene.nodes[2].mesh_count, 1u);
  EXPECT_EQ(scene.nodes[0].camera, 0u) << "cameras are not affected";
}

TEST(GltfLevels, TheFinestIsDrawnWithAWarning) {
  GltfBuilder b;
  const json attributes = {{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}};
  for (int i = 0; i < 3; ++i) b.node_with(attributes, {{"material", 0}});
  b.doc["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {1, 2};
  b.doc["materials"] = {{{"extensions", {{"MSFT_lod", {{"ids", {1}}}}}}}, json::object()};
  b.doc["scenes"] = {{{"nodes", {0}}}};
  b.doc["extensionsUsed"] = {"MSFT_lod"};
  const Scene scene = load(b);
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_TRUE(warns(scene, "nodes[0].MSFT_lod: the finest of 3 levels of detail is drawn")) << all_of(scene.warnings);
  EXPECT_TRUE(warns(scene, "materials[0].MSFT_lod: the finest of 2 levels")) << all_of(scene.warnings);
  b.doc["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {7};
  EXPECT_NE(refusal(b).find("nodes[0].extensions.MSFT_lod.ids[0]: 7 is out of range"), std::string::npos) << refusal(b);
}

TEST(GltfExtensions, DraftsAndUnknownOnesAreNamedOnce) {
  GltfBuilder b = whole_document();
  b.doc["extensionsUsed"] = {"KHR_materials_coat", "ACME_shiny", "KHR_texture_transform", "ACME_shiny"};
  const Scene scene = load(b);
  EXPECT_EQ(scene.extensions_ignored, (std::vector<std::string>{"KHR_materials_coat", "ACME_shiny"}));
  EXPECT_EQ(scene.extensions_read, std::vector<std::string>{"KHR_texture_transform"});
  EXPECT_TRUE(warns(scene, "\"KHR_materials_coat\" is a draft, which is not supported and is ignored"));
  EXPECT_TRUE(warns(scene, "\"ACME_shiny\" is not supported and is ignored"));
  b.doc["extensionsRequired"] = {"KHR_materials_coat"};
  EXPECT_NE(refusal(b).find("extensionsRequired: \"KHR_materials_coat\" is a draft"), std::string::npos) << refusal(b);
}

}  // namespace
}  // namespace sheaf
