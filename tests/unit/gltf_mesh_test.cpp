// SPDX-License-Identifier: MIT
// From the accessors of a primitive to a mesh: triangles, normals, tangents, weights, deltas.
#include <cmath>

#include "gltf_support.hpp"

namespace sheaf {
namespace {

using nlohmann::json;
using namespace test;

TEST(GltfMesh, FlatNormalsUnshareVerticesAndCarryAttributesAlong) {
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

TEST(GltfMesh, StripsAndFansFaceAsTheirFirstTriangle) {
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

TEST(GltfMesh, PointsAreSkippedWithAWarningThatNamesThem) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(unit_triangle, FLOAT, "VEC3", 3)}}, {{"mode", 0}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.nodes[0].mesh_count, 0u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("meshes[0].primitives[0]"), std::string::npos);
}

TEST(GltfMesh, InterleavedNormalizedAndQuantizedAccessors) {
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

TEST(GltfMesh, SparseOverlaysZerosAndData) {
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

TEST(GltfMesh, FarMeshesKeepTheirPrecision) {
  GltfBuilder b;
  const float far = 1e6f;
  b.node_with({{"POSITION", b.accessor<float>({far, 0, 0, far + 1, 0, 0, far, 0.0625f, 0}, FLOAT, "VEC3", 3)}});
  const Mesh mesh = load(b).meshes.at(0);
  EXPECT_EQ(mesh.centre.x, static_cast<double>(static_cast<float>(mesh.centre.x)));
  EXPECT_EQ(vertex(mesh, 1).x - vertex(mesh, 0).x, 1.0);
  EXPECT_LE(std::abs(mesh.positions[1].x), 1.0f);
}

TEST(GltfMesh, WeightsAreNormalizedAndTheWeightlessFollowTheFirstJoint) {
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

TEST(GltfMesh, TangentsFollowUAndTellMirroredCharts) {
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

}  // namespace
}  // namespace sheaf
