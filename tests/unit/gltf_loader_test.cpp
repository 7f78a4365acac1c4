// SPDX-License-Identifier: MIT
#include "scene/gltf_loader.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>

#include "core/error.hpp"
#include "core/sha256.hpp"
#include "gltf_builder.hpp"

namespace sheaf {
namespace {

using nlohmann::json;
using namespace test;

Scene load(GltfBuilder& builder, const std::string& selector = {}, const LoadLimits& limits = {}) {
  const TempFolder folder;
  return load_gltf(folder.write("scene.gltf", builder.text()), selector, limits);
}

// A mesh's vertex in object space.
glm::dvec3 vertex(const Mesh& mesh, std::size_t i) { return mesh.centre + glm::dvec3(mesh.positions[i]); }

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-6) {
  EXPECT_LT(glm::distance(a, b), tolerance)
      << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
}

TEST(Sha256, KnownDigests) {
  const auto digest = [](const std::string& text) { return sha256_of(text); };
  EXPECT_EQ(digest(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

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

TEST(GltfLoader, FlatNormalsUnshareVerticesAndCarryAttributesAlong) {
  // Two triangles of a folded square that share an edge.
  GltfBuilder b;
  const std::vector<float> p = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, c = {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3};
  b.node_with(
      {{"POSITION", b.accessor(p, FLOAT, "VEC3", 3)}, {"COLOR_0", b.accessor(c, FLOAT, "VEC3", 3)}},
      {{"indices", b.accessor<std::uint16_t>({0, 1, 2, 2, 1, 3}, USHORT, "SCALAR", 1)},
       {"targets", {{{"POSITION", b.accessor(c, FLOAT, "VEC3", 3)}, {"NORMAL", b.accessor(c, FLOAT, "VEC3", 3)}}}}});
  const Mesh mesh = load(b).meshes.at(0);
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.triangles[1], glm::uvec3(3, 4, 5));
  expect_near(vertex(mesh, 5), {1, 1, 1});
  EXPECT_EQ(mesh.colors[5], glm::vec4(3, 3, 3, 1));
  EXPECT_EQ(mesh.targets.at(0).positions[3], glm::vec3(2));
  EXPECT_TRUE(mesh.targets[0].normals.empty());
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.normals[3], glm::normalize(glm::dvec3(-1, -1, 1)));
}

TEST(GltfLoader, StripsAndFansFaceAsTheirFirstTriangle) {
  const std::vector<float> p = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  for (const int mode : {5, 6}) {
    GltfBuilder b;
    // Going round the square for the fan, zigzag for the strip.
    const std::vector<std::uint8_t> order =
        mode == 5 ? std::vector<std::uint8_t>{0, 1, 2, 3} : std::vector<std::uint8_t>{0, 1, 3, 2};
    b.node_with({{"POSITION", b.accessor(p, FLOAT, "VEC3", 3)}},
                {{"mode", mode}, {"indices", b.accessor(order, UBYTE, "SCALAR", 1)}});
    const Mesh mesh = load(b).meshes.at(0);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    for (const glm::vec3& n : mesh.normals) expect_near(n, {0, 0, 1});
  }
}

TEST(GltfLoader, PointsAreSkippedWithAWarningThatNamesThem) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}}, {{"mode", 0}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.nodes[0].mesh_count, 0u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("meshes[0].primitives[0]"), std::string::npos);
}

TEST(GltfLoader, InterleavedNormalizedAndQuantizedAccessors) {
  // Positions as SHORT with a stride of 8, normals as normalized BYTE, colours as normalized UNSIGNED_SHORT.
  GltfBuilder b;
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int view = b.view(std::vector<std::int16_t>{0, 0, 0, 99, 10, 0, 0, 99, 0, 20, 0, 99}, 8);
  const int positions =
      b.add("accessors", {{"bufferView", view}, {"componentType", SHORT}, {"type", "VEC3"}, {"count", 3}});
  const int normal_view = b.view(std::vector<std::int8_t>{0, -127, 0, 0, 0, -128, 0, 0, 0, 0, 0, 0}, 4);
  const int normals = b.add(
      "accessors",
      {{"bufferView", normal_view}, {"componentType", BYTE}, {"type", "VEC3"}, {"count", 3}, {"normalized", true}});
  const int colors =
      b.accessor<std::uint16_t>({65535, 0, 0, 65535, 0, 0, 0, 0, 0, 0, 0, 13107}, USHORT, "VEC4", 4, true);
  b.node_with({{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colors}});
  const Mesh mesh = load(b).meshes.at(0);
  expect_near(vertex(mesh, 1), {10, 0, 0});
  expect_near(vertex(mesh, 2), {0, 20, 0});
  expect_near(mesh.normals[0], {0, -1, 0});
  expect_near(mesh.normals[1], {0, -1, 0});
  expect_near(mesh.normals[2], {0, 0, 1});  // of no length in the file: the face's
  EXPECT_EQ(mesh.colors[0], glm::vec4(1, 0, 0, 1));
  EXPECT_FLOAT_EQ(mesh.colors[2].w, 0.2f);
}

TEST(GltfLoader, SparseOverlaysZerosAndData) {
  for (const bool has_base : {false, true}) {
    GltfBuilder b;
    json accessor = {{"componentType", FLOAT}, {"type", "VEC3"}, {"count", 3}};
    if (has_base) accessor["bufferView"] = b.view(unit_triangle);
    accessor["sparse"] = {{"count", 2},
                          {"indices", {{"bufferView", b.view<std::uint8_t>({1, 2})}, {"componentType", UBYTE}}},
                          {"values", {{"bufferView", b.view<float>({5, 0, 0, 0, 7, 0})}}}};
    b.node_with({{"POSITION", b.add("accessors", accessor)}});
    const Mesh mesh = load(b).meshes.at(0);
    expect_near(vertex(mesh, 0), {0, 0, 0});
    expect_near(vertex(mesh, 1), {5, 0, 0});
    expect_near(vertex(mesh, 2), {0, 7, 0});
  }
}

TEST(GltfLoader, FarMeshesKeepTheirPrecision) {
  GltfBuilder b;
  const float far = 1e6f;
  b.node_with({{"POSITION", b.accessor<float>({far, 0, 0, far + 1, 0, 0, far, 0.0625f, 0}, FLOAT, "VEC3", 3)}});
  const Mesh mesh = load(b).meshes.at(0);
  EXPECT_EQ(mesh.centre.x, static_cast<double>(static_cast<float>(mesh.centre.x)));
  EXPECT_EQ(vertex(mesh, 1).x - vertex(mesh, 0).x, 1.0);
  EXPECT_LE(std::abs(mesh.positions[1].x), 1.0f);
}

TEST(GltfLoader, WeightsAreNormalizedAndTheWeightlessFollowTheFirstJoint) {
  GltfBuilder b;
  const int joints = b.accessor<std::uint8_t>({1, 0, 0, 0, 1, 1, 0, 9, 0, 0, 0, 0}, UBYTE, "VEC4", 4);
  const int weights = b.accessor<float>({2, 0, 0, 0, 1, 3, 0, 0, 0, 0, 0, 0}, FLOAT, "VEC4", 4);
  const int node = b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)},
                                {"NORMAL", b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, FLOAT, "VEC3", 3)},
                                {"JOINTS_0", joints},
                                {"WEIGHTS_0", weights}});
  b.add("nodes", json::object());
  b.add("skins", {{"joints", {0, 1}}});
  b.doc["nodes"][node]["skin"] = 0;
  const Scene scene = load(b);
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.weights[0][0], 1.0f);
  EXPECT_EQ(mesh.weights[1][1], 0.75f);
  EXPECT_EQ(mesh.joints[1][3], 0);  // 9 in the file, with no weight
  EXPECT_EQ(mesh.weights[2][0], 1.0f);
  EXPECT_EQ(scene.nodes[0].skin, 0u);
  EXPECT_EQ(scene.skins[0].inverse_bind.at(1), glm::dmat4(1));
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfLoader, TangentsFollowUAndTellMirroredCharts) {
  // The square [0,1]² with u to the right and v down, then with u to the left.
  for (const float side : {1.0f, -1.0f}) {
    GltfBuilder b;
    const std::vector<float> p = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, n = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::vector<float> uv = {0, 1, side, 1, side, 0, 0, 0};
    const std::string png =
        "data:image/"
        "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";
    b.add("images", {{"uri", png}});
    b.add("textures", {{"source", 0}});
    b.add("materials", {{"normalTexture", {{"index", 0}}}});
    b.node_with({{"POSITION", b.accessor(p, FLOAT, "VEC3", 3)},
                 {"NORMAL", b.accessor(n, FLOAT, "VEC3", 3)},
                 {"TEXCOORD_0", b.accessor(uv, FLOAT, "VEC2", 2)}},
                {{"material", 0}, {"indices", b.accessor<std::uint8_t>({0, 1, 2, 0, 2, 3}, UBYTE, "SCALAR", 1)}});
    const Scene scene = load(b);
    ASSERT_EQ(scene.images.at(0).rgba.size(), 4u);
    ASSERT_EQ(scene.meshes.at(0).tangents.size(), 4u);
    for (const glm::vec4& t : scene.meshes[0].tangents) {
      expect_near(glm::dvec3(t), {side, 0, 0});
      EXPECT_EQ(t.w, side);
    }
  }
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

}  // namespace
}  // namespace sheaf
