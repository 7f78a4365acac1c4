// SPDX-License-Identifier: MIT
#include "scene/gltf_loader.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "core/error.hpp"
#include "gltf_support.hpp"

namespace sheaf {
namespace {

using nlohmann::json;
using namespace test;

TEST(GltfLoader, TriangleGetsFlatNormalsAndADefaultMaterial) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}});
  const Scene scene = load(b);
  ASSERT_EQ(scene.meshes.size(), 1u);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.centre, glm::dvec3(0.5, 0.5, 0));
  expect_near(vertex(mesh, 1), {1, 0, 0});
  ASSERT_EQ(mesh.normals.size(), 3u);
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.material, scene.materials.size() - 1);
  EXPECT_EQ(scene.roots, std::vector<std::uint32_t>{0});
}

TEST(GltfLoader, ABinaryFileReadsLikeItsText) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}});
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.glb", b.glb()));
  expect_near(vertex(scene.meshes.at(0), 2), {0, 1, 0});
}

TEST(GltfLoader, NoMeshIsValid) {
  GltfBuilder b;
  b.add("nodes", {{"name", "alone"}});
  EXPECT_EQ(load(b).order.size(), 1u);
}

TEST(GltfLoader, MaterialsWithTheirExtensions) {
  GltfBuilder b;
  b.add("materials", {{"emissiveFactor", {1, 0.5, 0}},
                      {"alphaMode", "MASK"},
                      {"alphaCutoff", 0.25},
                      {"doubleSided", true},
                      {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 1.5}}, {"roughnessFactor", 0.5}}},
                      {"extensions",
                       {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
                        {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
                        {"KHR_materials_ior", {{"ior", 1.33}}},
                        {"KHR_materials_volume",
                         {{"thicknessFactor", 2}, {"attenuationDistance", 3}, {"attenuationColor", {1, 0, 0.5}}}}}}});
  b.add("materials", {{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}, {"KHR_materials_unlit", json::object()}}}});
  const int positions = b.accessor(unit_triangle, FLOAT, "VEC3", 3);
  for (const int material : {0, 1}) b.node_with({{"POSITION", positions}}, {{"material", material}});
  const Scene scene = load(b);
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.emissive, glm::vec3(4, 2, 0));
  EXPECT_EQ(m.base_color, glm::vec4(1, 0.5, 0.25, 1));  // 1.5 is brought into range, with a warning
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_EQ(m.ior, 1.33f);
  EXPECT_EQ(m.thickness, 2.0f);
  EXPECT_EQ(m.attenuation_distance, 3.0f);
  EXPECT_EQ(m.attenuation_color, glm::vec3(1, 0, 0.5));
  EXPECT_GT(scene.materials.at(1).ior, 100.0f);
  EXPECT_TRUE(scene.materials[1].unlit);
}

TEST(GltfLoader, LightsCamerasAndInstances) {
  GltfBuilder b;
  b.doc["extensionsUsed"] = {"KHR_lights_punctual", "EXT_mesh_gpu_instancing", "ACME_shiny"};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 5}, {"range", 9}, {"spot", {{"outerConeAngle", 0.5}}}}};
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.5}}}});
  const int node = b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}});
  const int moves = b.accessor<float>({1, 2, 3, 4, 5, 6}, FLOAT, "VEC3", 3);
  b.doc["nodes"][node]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}},
                                        {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}};
  b.doc["nodes"][node]["camera"] = 0;
  const Scene scene = load(b);
  EXPECT_EQ(scene.lights.at(0).kind, LightKind::spot);
  EXPECT_EQ(scene.lights[0].range, 9.0f);
  EXPECT_EQ(scene.cameras.at(0).near, 0.5);
  EXPECT_TRUE(std::isinf(scene.cameras[0].far));
  EXPECT_EQ(scene.nodes[0].light, 0u);
  ASSERT_EQ(scene.nodes[0].instances.size(), 2u);
  EXPECT_EQ(scene.nodes[0].instances[1], glm::translate(glm::dmat4(1), glm::dvec3(4, 5, 6)));
  EXPECT_EQ(scene.extensions_ignored, std::vector<std::string>{"ACME_shiny"});
}

TEST(GltfLoader, ScenesAreChosenByNameAndIndex) {
  GltfBuilder b;
  b.add("nodes", {{"children", {1}}});
  b.add("nodes", json::object());
  b.add("nodes", json::object());
  b.add("scenes", {{"name", "left"}, {"nodes", {0}}});
  b.add("scenes", {{"name", "right"}, {"nodes", {2}}});
  b.doc["scene"] = 1;
  EXPECT_EQ(load(b).roots, std::vector<std::uint32_t>{2});
  EXPECT_EQ(load(b, "left").order, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(load(b, "0").order, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_THROW((void)load(b, "middle"), Error);
}

TEST(GltfLoader, ADeepChainOfNodesIsWalkedWithoutRecursion) {
  GltfBuilder b;
  constexpr int depth = 100'000;
  json nodes = json::array();
  for (int i = 0; i < depth; ++i) nodes.push_back(i + 1 < depth ? json{{"children", {i + 1}}} : json::object());
  b.doc["nodes"] = std::move(nodes);
  EXPECT_EQ(load(b).order.size(), static_cast<std::size_t>(depth));
}

TEST(GltfLoader, BuffersBesideTheSceneMayBeLongerAndPercentEncoded) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}});
  b.doc["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", "sub/my%20data.bin"}}};
  const TempFolder folder;
  (void)folder.write("sub/my data.bin", std::string(b.bytes.begin(), b.bytes.end()) + "more");
  const Scene scene = load_gltf(folder.write("scene.gltf", b.doc.dump()));
  expect_near(vertex(scene.meshes.at(0), 1), {1, 0, 0});
}

TEST(GltfLoader, LimitsAreErrorsOfTheirOwn) {
  const auto kind_under = [](const LoadLimits& limits) {
    GltfBuilder b;
    b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}});
    try {
      (void)load(b, {}, limits);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::usage;
  };
  EXPECT_EQ(kind_under({.file_bytes = 10}), ErrorKind::limit);
  EXPECT_EQ(kind_under({.triangles = 0}), ErrorKind::limit);
  EXPECT_EQ(kind_under({.vertices = 2}), ErrorKind::limit);
  EXPECT_EQ(kind_under({.nodes = 0}), ErrorKind::limit);
}

TEST(GltfLoader, EveryAssetLoadsOrIsRefusedByName) {
  const char* variable = std::getenv("SHEAF_ASSETS");
  const std::filesystem::path assets = variable ? variable : SHEAF_SOURCE_DIR "/../shared/assets";
  if (!std::filesystem::exists(assets)) GTEST_SKIP() << "no assets at " << assets;
  int loaded = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(assets)) {
    if (entry.path().extension() != ".gltf" && entry.path().extension() != ".glb") continue;
    try {
      const Scene scene = load_gltf(entry.path().string());
      EXPECT_FALSE(scene.order.empty()) << entry.path();
      ++loaded;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("extensionsRequired"), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(loaded, 0);
}

TEST(GltfLoader, FactorsOutOfRangeAreNamedUnlessItIsRounding) {
  GltfBuilder b = whole_document();
  b.doc["meshes"][0]["primitives"][0]["material"] = 0;
  b.doc["materials"] = {{{"pbrMetallicRoughness", {{"roughnessFactor", 1.00000001}}}}};
  Scene scene = load(b);
  EXPECT_FALSE(warns(scene, "outside its range")) << all_of(scene.warnings);
  EXPECT_EQ(scene.materials[0].roughness, 1);
  b.doc["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 1.01;
  scene = load(b);
  EXPECT_TRUE(warns(scene, "roughnessFactor: 1.010000 is outside its range, 1.000000 is used"));
}

}  // namespace
}  // namespace sheaf
