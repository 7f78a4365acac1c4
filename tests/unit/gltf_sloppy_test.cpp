// SPDX-License-Identifier: MIT
// Files that break a rule of form and have one meaning: read, with a warning that names the place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>

#include "core/error.hpp"
#include "gltf_support.hpp"
#include "scene/pose.hpp"

namespace sheaf {
namespace {

using nlohmann::json;
using namespace test;

struct Case {
  const char* name;
  const char* warning;  // "" for none
  std::function<void(json&)> change;
  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

std::string changed_uri(const json& doc, const std::string& from, const std::string& to) {
  std::string uri = doc["buffers"][0]["uri"];
  return uri.replace(uri.find(from), from.size(), to);
}

std::string url_alphabet(std::string uri) {
  const auto data = uri.begin() + static_cast<std::ptrdiff_t>(uri.find(',') + 1);
  std::replace(data, uri.end(), '+', '-');
  std::replace(data, uri.end(), '/', '_');
  return uri;
}

// A mesh with one triangle, a skin, a camera, a light and an animation. Its data URI holds 3 k + 1 or 3 k + 2 bytes.
const Case cases[] = {
    {"nothing", "", [](json&) {}},
    {"null", "nodes[0].skin: is null", [](json& d) { d["nodes"][0]["skin"] = nullptr; }},
    {"null_collection", "textures: is null", [](json& d) { d["textures"] = nullptr; }},
    {"null_in_extras", "", [](json& d) { d["nodes"][0]["extras"]["a"] = nullptr; }},
    {"integer_as_fraction", "accessors[0].count: is written 3.0", [](json& d) { d["accessors"][0]["count"] = 3.0; }},
    {"index_as_fraction", "attributes.POSITION: is written 0.0",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 0.0; }},
    {"joint_as_fraction", "skins[0].joints[1]: is written 2.0", [](json& d) { d["skins"][0]["joints"][1] = 2.0; }},
    {"version_number", "asset.version: is a number", [](json& d) { d["asset"]["version"] = 2.0; }},
    {"stride_0", "bufferViews[0].byteStride: is 0", [](json& d) { d["bufferViews"][0]["byteStride"] = 0; }},
    {"range_0", "lights[0].range: is 0, taken as infinite",
     [](json& d) { d["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = 0; }},
    {"range_null", "lights[0].range: is null",
     [](json& d) { d["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = nullptr; }},
    {"zfar_0", "cameras[0].perspective.zfar: is 0, taken as infinite",
     [](json& d) { d["cameras"][0]["perspective"]["zfar"] = 0; }},
    {"attenuation_0", "materials[0].attenuationDistance: is 0, taken as infinite",
     [](json& d) { d["materials"][0]["extensions"]["KHR_materials_volume"]["attenuationDistance"] = 0; }},
    {"attenuation_null", "KHR_materials_volume.attenuationDistance: is null",
     [](json& d) { d["materials"][0]["extensions"]["KHR_materials_volume"]["attenuationDistance"] = nullptr; }},
    {"matrix_1", "nodes[0].matrix: has a last row near 0 0 0 1",
     [](json& d) { d["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.99999}; }},
    {"matrix_0", "nodes[0].matrix: has a last row near 0 0 0 1",
     [](json& d) { d["nodes"][0]["matrix"] = {1, 0, 0, 1e-9, 0, 1, 0, -2e-8, 0, 0, 1, 0, 0, 0, 0, 1}; }},
    {"uri_longer", "buffers[0]: its data URI holds",
     [](json& d) { d["buffers"][0]["byteLength"] = d["buffers"][0]["byteLength"].get<int>() - 1; }},
    {"uri_shorter", "byteLength says 9999", [](json& d) { d["buffers"][0]["byteLength"] = 9999; }},
    {"view_past_length", "but not of what was read", [](json& d) { d["buffers"][0]["byteLength"] = 8; }},
    {"type_unknown", R"(has the media type "image/jpg")",
     [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, "application/octet-stream", "image/jpg"); }},
    {"type_upper_case", R"(has the media type "APPLICATION/OCTET-STREAM")",
     [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, "application/octet-stream", "APPLICATION/OCTET-STREAM"); }},
    {"type_empty", R"(has the media type "")",
     [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, "application/octet-stream", ""); }},
    {"type_parameters", "has parameters in its media type",
     [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, ";base64", ";charset=utf-8;name=\"a b\";base64"); }},
    {"scheme_upper_case", "", [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, "data:", "DATA:"); }},
    {"base64_upper_case", "", [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, ";base64", ";BASE64"); }},
    {"base64_lines", "its base64 is not in the usual form",
     [](json& d) { d["buffers"][0]["uri"] = changed_uri(d, ";base64,", ";base64,\n "); }},
    {"base64_padding", "its base64 is not in the usual form",
     [](json& d) {
       std::string uri = d["buffers"][0]["uri"];
       ASSERT_TRUE(uri.ends_with('='));
       while (uri.ends_with('=')) uri.pop_back();
       d["buffers"][0]["uri"] = uri;
     }},
    {"base64_escaped", "",
     [](json& d) {
       const std::string uri = d["buffers"][0]["uri"];
       std::string out = uri.substr(0, uri.find(',') + 1);
       for (const char c : uri.substr(out.size())) out += c == '=' ? "%3D" : c == '/' ? "%2f" : std::string(1, c);
       d["buffers"][0]["uri"] = out;
     }},
    {"base64_of_urls", "its base64 is not in the usual form",
     [](json& d) {
       const std::string uri = d["buffers"][0]["uri"];
       ASSERT_NE(uri, url_alphabet(uri));
       d["buffers"][0]["uri"] = url_alphabet(uri);
     }},
    // Nothing uses what is added here.
    {"unused_image_missing", R"(images[0].uri: "gone.png" does not exist, but nothing uses it)",
     [](json& d) {
       d["images"] = {{{"uri", "gone.png"}}};
     }},
    {"unused_image_outside", "leaves the scene's folder, but nothing uses it",
     [](json& d) {
       d["images"] = {{{"uri", "../gone.png"}}};
     }},
    {"unused_image_view", "images[0].bufferView: 99 is out of range",
     [](json& d) {
       d["images"] = {{{"bufferView", 99}}};
     }},
    {"unused_buffer_missing", R"(buffers[1].uri: "gone.bin" does not exist, but nothing uses it)",
     [](json& d) {
       d["buffers"].push_back({{"byteLength", 4}, {"uri", "gone.bin"}});
     }},
    {"unused_buffer_length", "buffers[1].byteLength: 0 is out of range",
     [](json& d) {
       d["buffers"].push_back({{"byteLength", 0}});
     }},
    {"unused_view", "are outside buffers[0]",
     [](json& d) {
       d["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 99999}});
     }},
    {"unused_view_buffer", ".buffer: 7 is out of range",
     [](json& d) {
       d["bufferViews"].push_back({{"buffer", 7}, {"byteLength", 9}});
     }},
    {"unused_accessor", ".type: \"VEC9\" is not SCALAR",
     [](json& d) {
       d["accessors"].push_back({{"componentType", 5126}, {"count", 1}, {"type", "VEC9"}});
     }},
    {"unused_accessor_component", ".componentType: 9999 is out of range",
     [](json& d) {
       d["accessors"].push_back({{"componentType", 9999}, {"count", 1}, {"type", "VEC3"}});
     }},
    {"unused_texture", "textures[0].source: 3 is out of range",
     [](json& d) {
       d["textures"] = {{{"source", 3}}};
     }},
    {"unused_sampler", "samplers[0].wrapS: must be a whole number",
     [](json& d) {
       d["samplers"] = {{{"wrapS", "x"}}};
     }},
    {"unused_material", "materials[1].alphaCutoff: must be a number",
     [](json& d) {
       d["materials"].push_back({{"alphaCutoff", "x"}});
     }},
    {"unused_number", "materials[1]: must be an object", [](json& d) { d["materials"].push_back(7); }},
    {"unused_mesh", "meshes[1]: primitives is missing", [](json& d) { d["meshes"].push_back(json::object()); }},
    {"unused_mesh_index", "meshes[1].primitives[0].attributes.POSITION: 99 is out of range",
     [](json& d) {
       d["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 99}}}}}}});
     }},
    {"unused_node", "nodes[3].mesh: 9 is out of range",
     [](json& d) {
       d["nodes"].push_back({{"mesh", 9}});
     }},
    {"unused_scene", "scenes[1].nodes[0]: 9 is out of range",
     [](json& d) {
       d["scenes"].push_back({{"nodes", {9}}});
     }},
    {"unused_skin", "skins[1].joints[0]: 77 is out of range",
     [](json& d) {
       d["skins"].push_back({{"joints", {77}}});
     }},
    {"unused_camera", "cameras[1].perspective.yfov: must be between 0 and pi: the camera cannot be used",
     [](json& d) {
       d["cameras"].push_back({{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}});
     }},
    {"unused_camera_type", "cameras[1].type: is not perspective or orthographic",
     [](json& d) {
       d["cameras"].push_back({{"type", "fisheye"}});
     }},
    {"unused_light", R"(lights[1].type: "area" is not directional, point or spot, but nothing uses it)",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"].push_back({{"type", "area"}});
     }},
    {"unused_light_number", "lights[1]: must be an object",
     [](json& d) { d["extensions"]["KHR_lights_punctual"]["lights"].push_back(3); }},
    {"unused_animation", "animations[1].samplers[0].input: 99 is out of range",
     [](json& d) {
       d["animations"].push_back(d["animations"][0]);
       d["animations"][1]["samplers"][0]["input"] = 99;
     }},
};

class SloppyGltf : public testing::TestWithParam<Case> {};

TEST_P(SloppyGltf, IsReadWithAWarning) {
  GltfBuilder b = whole_document();
  b.bytes.insert(b.bytes.end(), {0xfb, 0xff, 0xbf, 0xfe});  // '+' and '/' in base64
  while (b.bytes.size() % 3 != 1) b.bytes.push_back(0xff);
  b.embed();
  GetParam().change(b.doc);
  const TempFolder folder, outside;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  expect_triangle(scene);
  EXPECT_EQ(select_animations(scene, ""), std::vector<std::uint32_t>{0});
  EXPECT_TRUE(scene.cameras[0].fault.empty());
  if (*GetParam().warning == '\0') {
    EXPECT_TRUE(scene.warnings.empty()) << all_of(scene.warnings);
  } else {
    EXPECT_TRUE(warns(scene, GetParam().warning)) << all_of(scene.warnings);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SloppyGltf, testing::ValuesIn(cases),
                         [](const auto& one) { return std::string(one.param.name); });

// What is broken is refused by whoever needs it.
TEST(SloppyGltfUse, OfWhatIsBrokenIsRefused) {
  GltfBuilder b = whole_document();
  b.embed();
  b.doc["animations"].push_back(b.doc["animations"][0]);
  b.doc["animations"][1]["samplers"][0]["input"] = 99;
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  EXPECT_THROW((void)select_animations(scene, "1"), Error);
  EXPECT_THROW((void)select_animations(scene, "all"), Error);
}

TEST(SloppyGltfRange, ZeroIsInfinite) {
  GltfBuilder b = whole_document();
  b.doc["extensions"]["KHR_lights_punctual"]["lights"][0]["range"] = 0;
  b.doc["materials"][0]["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1}, {"attenuationDistance", 0}};
  b.doc["cameras"][0]["perspective"]["zfar"] = 0;
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  EXPECT_TRUE(std::isinf(scene.lights[0].range));
  EXPECT_TRUE(std::isinf(scene.materials[0].attenuation_distance));
  EXPECT_TRUE(std::isinf(scene.cameras[0].far));
}

// Joints count where a node has a skin.
TEST(SloppyGltfMesh, JointsOfOnePrimitiveWithoutASkin) {
  GltfBuilder b = whole_document();
  b.doc["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"targets", {{{"POSITION", 7}}}}});
  const TempFolder folder;
  EXPECT_THROW((void)load_gltf(folder.write("scene.gltf", b.text())), Error);
  b.doc["nodes"][0].erase("skin");
  EXPECT_EQ(load_gltf(folder.write("scene.gltf", b.text())).meshes.size(), 2u);
  b.doc["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  EXPECT_EQ(load_gltf(folder.write("scene.gltf", b.text())).meshes.size(), 2u);
}

TEST(SloppyGltfWarnings, AreBoundedInNumber) {
  GltfBuilder b = whole_document();
  b.embed();
  for (int i = 0; i < 500; ++i) b.doc["nodes"].push_back({{"camera", nullptr}});
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  EXPECT_EQ(scene.warnings.size(), 21u);
  EXPECT_TRUE(warns(scene, "480 more warnings like \"nodes[3].camera: is null")) << all_of(scene.warnings);
}

TEST(SloppyGltfFiles, NumbersThatMayHaveAFractionAreNotTakenForIntegers) {
  GltfBuilder b = whole_document();
  b.doc["nodes"][0]["translation"] = {0.0, 0.0, 0.0};
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  EXPECT_EQ(all_of(scene.warnings), "");
}

}  // namespace
}  // namespace sheaf
