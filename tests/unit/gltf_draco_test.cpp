// SPDX-License-Identifier: MIT
// KHR_draco_mesh_compression: meshes that the test encodes by libdraco, without loss, come back as they were.
#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <algorithm>
#include <array>
#include <set>

#include "core/error.hpp"
#include "gltf_support.hpp"
#include "scene/draco_mesh.hpp"

namespace sheaf {
namespace {

using namespace test;
using nlohmann::json;
using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t id_step = 5;  // unique ids that are not the attributes' numbers: 5, 10, …

struct Soup {  // a corner: position, normal, texture coordinates, joints, weights
  std::vector<std::array<float, 3>> positions, normals;
  std::vector<std::array<float, 2>> uvs;
  std::vector<std::array<std::uint16_t, 4>> joints;
  std::vector<std::array<float, 4>> weights;
};

// A folded sheet of n by n squares.
Soup sheet(int n) {
  Soup soup;
  const auto corner = [&](int x, int y) {
    const auto fx = static_cast<float>(x), fy = static_cast<float>(y);
    soup.positions.push_back({fx / 3, fy / 7, static_cast<float>(x % 2) / 11});
    soup.normals.push_back({0.6f, 0, 0.8f});
    soup.uvs.push_back({fx / 13, 1 - fy / 17});
    soup.joints.push_back({static_cast<std::uint16_t>(x % 2), static_cast<std::uint16_t>(300 + y), 0, 0});
    soup.weights.push_back({0.25f, 0.75f, 0, 0});
  };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {0, 1}, {1, 0}, {1, 1}}) corner(x + dx, y + dy);
  return soup;
}

Bytes encode(const Soup& soup, int method) {
  draco::TriangleSoupMeshBuilder builder;
  const int faces = static_cast<int>(soup.positions.size() / 3);
  builder.Start(faces);
  const std::array<int, 5> ids{builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32),
                               builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32),
                               builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT16),
                               builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32)};
  for (int f = 0; f < faces; ++f) {
    const auto set = [&](std::size_t which, const auto& values) {
      const auto at = static_cast<std::size_t>(3 * f);
      builder.SetAttributeValuesForFace(ids[which], draco::FaceIndex(static_cast<std::uint32_t>(f)), values[at].data(),
                                        values[at + 1].data(), values[at + 2].data());
    };
    set(0, soup.positions), set(1, soup.normals), set(2, soup.uvs), set(3, soup.joints), set(4, soup.weights);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  for (std::uint32_t i = 0; i < ids.size(); ++i) mesh->attribute(ids[i])->set_unique_id((i + 1) * id_step);
  draco::ExpertEncoder encoder(*mesh);
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer out;
  EXPECT_TRUE(encoder.EncodeToBuffer(&out).ok());
  return {out.data(), out.data() + out.size()};
}

struct DracoScene {
  GltfBuilder b;
  explicit DracoScene(const Bytes& data, int triangles, int vertices) {
    const auto accessor = [&](int type, const char* shape, int count) {
      return b.add("accessors", {{"componentType", type}, {"type", shape}, {"count", count}});
    };
    const json attributes = {{"POSITION", accessor(FLOAT, "VEC3", vertices)},
                             {"NORMAL", accessor(FLOAT, "VEC3", vertices)},
                             {"TEXCOORD_0", accessor(FLOAT, "VEC2", vertices)},
                             {"JOINTS_0", accessor(USHORT, "VEC4", vertices)},
                             {"WEIGHTS_0", accessor(FLOAT, "VEC4", vertices)}};
    const json ids = {{"POSITION", 5}, {"NORMAL", 10}, {"TEXCOORD_0", 15}, {"JOINTS_0", 20}, {"WEIGHTS_0", 25}};
    const json extension = {{"bufferView", b.view(data)}, {"attributes", ids}};
    b.node_with(attributes, {{"indices", accessor(UINT, "SCALAR", 3 * triangles)},
                             {"extensions", {{"KHR_draco_mesh_compression", extension}}}});
    b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  }
  json& primitive() { return b.doc["meshes"][0]["primitives"][0]; }
  json& compressed() { return primitive()["extensions"]["KHR_draco_mesh_compression"]; }
  void give_skin() {  // 400 joints, all of which are the mesh's own node's child
    b.doc["skins"] = {{{"joints", json::array()}}};
    for (int j = 0; j < 400; ++j) b.doc["skins"][0]["joints"].push_back(b.add("nodes", json::object()));
    b.doc["nodes"][0]["skin"] = 0;
  }
};

void expect_refused(DracoScene& scene, const std::string& text, const LoadLimits& limits = {}) {
  try {
    (void)load(scene.b, {}, limits);
    ADD_FAILURE() << "was read, and should say: " << text;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

using Corner = std::vector<float>;
using Triangles = std::multiset<std::vector<Corner>>;

std::vector<Corner> turned(std::vector<Corner> corners) {
  std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
  return corners;
}

Triangles triangles_of(const Soup& soup) {
  Triangles out;
  for (std::size_t t = 0; t < soup.positions.size(); t += 3) {
    std::vector<Corner> corners;
    for (std::size_t c = t; c < t + 3; ++c) {
      const auto &p = soup.positions[c], &n = soup.normals[c];
      corners.push_back({p[0], p[1], p[2], n[0], n[1], n[2], soup.uvs[c][0], soup.uvs[c][1],
                         static_cast<float>(soup.joints[c][0]), static_cast<float>(soup.joints[c][1])});
    }
    out.insert(turned(corners));
  }
  return out;
}

Triangles triangles_of(const Mesh& mesh) {
  Triangles out;
  for (const glm::uvec3& triangle : mesh.triangles) {
    std::vector<Corner> corners;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = triangle[c];
      const glm::vec3 p(vertex(mesh, v)), n = mesh.normals[v];
      corners.push_back({p.x, p.y, p.z, n.x, n.y, n.z, mesh.uv0[v].x, mesh.uv0[v].y,
                         static_cast<float>(mesh.joints[v][0]), static_cast<float>(mesh.joints[v][1])});
    }
    out.insert(turned(corners));
  }
  return out;
}

void expect_same(const Triangles& a, const Triangles& b) {
  ASSERT_EQ(a.size(), b.size());
  auto other = b.begin();
  for (const auto& triangle : a) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < triangle[c].size(); ++i) EXPECT_NEAR(triangle[c][i], (*other)[c][i], 1e-6);
    ++other;
  }
}

class GltfDraco : public ::testing::TestWithParam<int> {};

TEST_P(GltfDraco, GivesBackWhatWasCompressed) {
  const Soup soup = sheet(4);
  DracoScene scene(encode(soup, GetParam()), 32, 25);
  scene.give_skin();
  const Scene loaded = load(scene.b);
  ASSERT_EQ(loaded.meshes.size(), 1u);
  EXPECT_EQ(loaded.meshes[0].positions.size(), 25u);
  EXPECT_EQ(loaded.meshes[0].weights[0][1], 0.75f);
  expect_same(triangles_of(loaded.meshes[0]), triangles_of(soup));
  EXPECT_FALSE(warns(loaded, "count")) << all_of(loaded.warnings);
  EXPECT_EQ(loaded.extensions_read, std::vector<std::string>{"KHR_draco_mesh_compression"});
}

TEST_P(GltfDraco, IsDamageWhereverItIsCut) {
  const Bytes whole = encode(sheet(2), GetParam());
  const std::vector<DracoAttribute> wanted = {{5, FLOAT, 3}, {20, USHORT, 4}};
  const DracoLimits limits{1000, 1000, 1 << 20};
  EXPECT_EQ(decode_draco(whole, wanted, limits).fault, "");
  for (std::size_t size = 0; size < whole.size() - 1; ++size)
    EXPECT_NE(decode_draco({whole.data(), size}, wanted, limits).fault, "") << "cut to " << size << " bytes";
}

INSTANTIATE_TEST_SUITE_P(Methods, GltfDraco,
                         ::testing::Values(draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING));

TEST(GltfDracoFile, AccessorsAreOfTheDecodedMesh) {
  const Bytes data = encode(sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  DracoScene scene(data, 30, 26);  // as where a writer dropped triangles
  const Scene loaded = load(scene.b);
  EXPECT_EQ(loaded.meshes.at(0).triangles.size(), 32u);
  EXPECT_TRUE(warns(loaded, "accessors[5].count: is 90, the KHR_draco_mesh_compression data has 96 indices"));
  EXPECT_TRUE(warns(loaded, "accessors[0].count: is 26, the KHR_draco_mesh_compression data has 25 vertices"));
}

TEST(GltfDracoFile, MorphTargetsStayPlainAndMustFit) {
  const Bytes data = encode(sheet(1), draco::MESH_SEQUENTIAL_ENCODING);
  for (const std::size_t vertices : {4, 5}) {
    DracoScene scene(data, 2, 4);
    std::vector<float> deltas(3 * vertices, 0.5f);
    scene.primitive()["targets"] = {{{"POSITION", scene.b.accessor(deltas, FLOAT, "VEC3", 3)}}};
    if (vertices == 5) {
      expect_refused(scene, "has not as many elements as the primitive's POSITION");
    } else {
      const Scene loaded = load(scene.b);
      EXPECT_EQ(loaded.meshes.at(0).targets.at(0).positions.at(3), glm::vec3(0.5f));
    }
  }
}

TEST(GltfDracoFile, SaysWhatIsWrongAndWhere) {
  const Bytes data = encode(sheet(1), draco::MESH_EDGEBREAKER_ENCODING);
  const std::string place = "meshes[0].primitives[0].KHR_draco_mesh_compression";
  const auto refused = [&](const auto& change, const std::string& text, Bytes bytes) {
    DracoScene scene(bytes, 2, 4);
    change(scene);
    expect_refused(scene, text);
  };
  const auto keep = [](DracoScene&) {};
  refused([](DracoScene& s) { s.compressed()["attributes"]["POSITION"] = 3; }, place + ": has no attribute 3", data);
  refused([](DracoScene& s) { s.compressed()["attributes"]["POSITION"] = 15; },
          "attribute 15 has 2 components, its accessor 3", data);
  refused([](DracoScene& s) { s.compressed()["attributes"]["POSITION"] = -1; }, "must be the id of an attribute", data);
  refused([](DracoScene& s) { s.compressed()["bufferView"] = 9; }, "bufferView: 9 is out of range", data);
  refused(keep, place + ": is not Draco data", Bytes(40));
  Bytes older = data;
  older[6] = 1;
  refused(keep, "is of Draco's bitstream version 2.1, only 2.2 is supported", older);
  Bytes points = data;
  points[7] = 0;
  refused(keep, "holds points, not a mesh", points);
}

TEST(GltfDracoFile, WhatItClaimsIsLimited) {
  // A sequential mesh whose counts are varints after the header: faces, then vertices.
  Bytes bomb = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 0, 0, 0};
  const auto counts = [&](std::initializer_list<std::uint8_t> bytes) {
    Bytes out = bomb;
    out.insert(out.end(), bytes);
    out.resize(out.size() + 40);
    return out;
  };
  DracoScene points(counts({1, 0xff, 0xff, 0xff, 0xff, 0x0f}), 1, 4);
  expect_refused(points, "has 4294967295 vertices, a scene may have 128000000");
  DracoScene faces(counts({0xff, 0xff, 0xff, 0x0f, 3}), 1, 4);
  expect_refused(faces, "has 33554431 triangles in 56 bytes");
  DracoScene attributes(encode(sheet(4), draco::MESH_SEQUENTIAL_ENCODING), 32, 25);
  LoadLimits limits;
  limits.file_bytes = 1250;  // enough for the file, and 56 bytes are a vertex
  const Bytes small = encode(sheet(4), draco::MESH_SEQUENTIAL_ENCODING);
  const DracoMesh mesh = decode_draco(small, {}, {1000, 1000, limits.file_bytes});
  EXPECT_TRUE(mesh.over_limit);
  EXPECT_EQ(mesh.fault, "holds more than 1250 bytes");
}

}  // namespace
}  // namespace sheaf
