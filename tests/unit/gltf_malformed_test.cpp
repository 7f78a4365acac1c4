// SPDX-License-Identifier: MIT
// Files that are wrong in one place each: an error that names the place, never a crash. Run under the sanitizers too.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <ostream>

#include "core/error.hpp"
#include "gltf_builder.hpp"
#include "scene/gltf_loader.hpp"
#include "scene/pose.hpp"

namespace sheaf {
namespace {

using nlohmann::json;
using namespace test;

// What `whole_document` becomes, and a part of the error that must follow.
struct Case {
  const char* name;
  const char* expected;
  const char* pointer;  // into the JSON
  const char* value;    // put there; "" takes it away
  int view = -1;        // or bytes put into a buffer view
  std::size_t offset = 0;
  std::vector<std::uint8_t> bytes = {};
  friend void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }
};

const Case cases[] = {
    // clang-format off
    {"asset_missing", "asset is missing", "/asset", ""},
    {"version_1", R"(asset.version: "1.0")", "/asset/version", R"("1.0")"},
    {"required_extension", R"(extensionsRequired: "ACME_x" is not supported)", "/extensionsRequired", R"(["ACME_x"])"},
    {"required_number", "extensionsRequired[0]: must be a string", "/extensionsRequired", "[1]"},
    {"nodes_object", "nodes: must be an array", "/nodes", "{}"},
    {"node_number", "nodes[1]: must be an object", "/nodes/1", "7"},
    {"name_number", "nodes[1].name: must be a string", "/nodes/1/name", "7"},
    {"scene_index", "scene: 4 is out of range", "/scene", "4"},
    {"scene_node", "scenes[0].nodes[0]: 99 is out of range", "/scenes/0/nodes", "[99]"},
    {"scene_child", "not a root", "/scenes/0/nodes", "[2]"},
    {"scene_twice", "listed twice", "/scenes/0/nodes", "[0,0]"},
    {"node_mesh", "nodes[0].mesh: 3 is out of range", "/nodes/0/mesh", "3"},
    {"node_mesh_wraps", "nodes[0].mesh: 4294967296 is out of range", "/nodes/0/mesh", "4294967296"},
    {"node_mesh_negative", "nodes[0].mesh: -1 is out of range", "/nodes/0/mesh", "-1"},
    {"node_mesh_fraction", "nodes[0].mesh: must be an index", "/nodes/0/mesh", "0.5"},
    {"node_skin", "nodes[0].skin: 9 is out of range", "/nodes/0/skin", "9"},
    {"node_camera", "nodes[0].camera: 9 is out of range", "/nodes/0/camera", "9"},
    {"node_light", "light: 9 is out of range", "/nodes/0/extensions/KHR_lights_punctual/light", "9"},
    {"node_child", "nodes[1].children[0]: 9 is out of range", "/nodes/1/children", "[9]"},
    {"node_cycle", "nodes[1]: is its own ancestor", "/nodes/2/children", "[1]"},
    {"node_two_parents", "already is a child of node", "/nodes/0/children", "[2]"},
    {"node_matrix_short", "nodes[1].matrix: must hold 16 numbers", "/nodes/1/matrix", "[1,2]"},
    {"node_matrix_projective", "nodes[1].matrix: has a last row", "/nodes/1/matrix", "[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]"},
    {"node_translation_huge", "nodes[1].translation[0]: 1e+300 is out of range", "/nodes/1/translation", "[1e300,0,0]"},
    {"node_weights", "nodes[0].weights: has 3 weights for 1", "/nodes/0/weights", "[1,2,3]"},
    {"mesh_weights", "meshes[0].weights: has 2 weights for 1", "/meshes/0/weights", "[1,2]"},
    {"mesh_mode", "primitives[0].mode: 7 is out of range", "/meshes/0/primitives/0/mode", "7"},
    {"mesh_attribute", "attributes.POSITION: 99 is out of range", "/meshes/0/primitives/0/attributes/POSITION", "99"},
    {"mesh_material", "primitives[0].material: 9 is out of range", "/meshes/0/primitives/0/material", "9"},
    {"mesh_joints_alone", "JOINTS_0 and WEIGHTS_0 must come together", "/meshes/0/primitives/0/attributes/WEIGHTS_0", ""},
    {"mesh_counts_differ", "WEIGHTS_0 has 2 elements, POSITION 3", "/accessors/2/count", "2"},
    {"target_counts_differ", "targets[0]: POSITION has not as many", "/meshes/0/primitives/0/targets/0/POSITION", "4"},
    {"index_float", "as indices cannot be FLOAT", "/meshes/0/primitives/0/indices", "4"},
    {"joint_too_large", "its mesh refers to joint 1, skins[0] has 1", "/skins/0/joints", "[1]"},
    {"joints_empty", "skins[0].joints: is empty", "/skins/0/joints", "[]"},
    {"bind_matrices_few", "has 2 joints and 1 inverse bind", "/accessors/6/count", "1"},
    {"accessor_type", "accessors[0].type: must be a string", "/accessors/0/type", "3"},
    {"accessor_type_unknown", "VEC9", "/accessors/0/type", R"("VEC9")"},
    {"accessor_wrong_width", "as POSITION must have 3 components, not 2", "/accessors/0/type", R"("VEC2")"},
    {"accessor_component", "accessors[0].componentType: 9999 is out of range", "/accessors/0/componentType", "9999"},
    {"accessor_component_int", "accessors[0].componentType: 5124 is none of glTF's", "/accessors/0/componentType", "5124"},
    {"accessor_count_zero", "accessors[0].count: 0 is out of range", "/accessors/0/count", "0"},
    {"accessor_count_huge", "accessors[0]: has more than", "/accessors/0/count", "9007199254740991"},
    {"accessor_past_view", "elements end outside bufferViews[0]", "/accessors/0/count", "4"},
    {"accessor_offset_huge", "elements end outside bufferViews[0]", "/accessors/0/byteOffset", "9007199254740988"},
    {"accessor_offset_negative", "accessors[0].byteOffset: -4 is out of range", "/accessors/0/byteOffset", "-4"},
    {"accessor_unaligned", "accessors[4]: its data is not aligned to 4 bytes", "/accessors/4/byteOffset", "2"},
    {"accessor_view", "accessors[0].bufferView: 99 is out of range", "/accessors/0/bufferView", "99"},
    {"stride_small", "byteStride 4 is smaller than an element of 12", "/bufferViews/0/byteStride", "4"},
    {"stride_odd", "byteStride: must be a multiple of 4", "/bufferViews/0/byteStride", "13"},
    {"view_past_buffer", "bufferViews[0]: bytes 0 to 99999 are outside buffers[0]", "/bufferViews/0/byteLength", "99999"},
    {"view_offset_wraps", "bufferViews[0].byteOffset: 18446744073709551615 is out of range", "/bufferViews/0/byteOffset", "18446744073709551615"},
    {"view_buffer", "bufferViews[0].buffer: 5 is out of range", "/bufferViews/0/buffer", "5"},
    {"sparse_count", "sparse.count: is larger", "/accessors/7/sparse/count", "4"},
    {"sparse_values", "sparse.values: 2 elements end outside", "/accessors/7/sparse/values/byteOffset", "4"},
    {"sparse_component", "sparse.indices.componentType: must be an unsigned", "/accessors/7/sparse/indices/componentType", "5122"},
    {"sparse_missing", "accessors[7].sparse: indices is missing", "/accessors/7/sparse/indices", ""},
    {"output_count", "output holds 4 numbers, its keys need 8", "/accessors/5/count", "1"},
    {"channel_sampler", "animations[0].channels[0].sampler: out of range", "/animations/0/channels/0/sampler", "1"},
    {"channel_path", R"("colour" is not translation)", "/animations/0/channels/0/target/path", R"("colour")"},
    {"interpolation", R"(interpolation "SMOOTH")", "/animations/0/samplers/0/interpolation", R"("SMOOTH")"},
    {"material_factor", "baseColorFactor: must hold 4 numbers", "/materials/0/pbrMetallicRoughness/baseColorFactor", "[1]"},
    {"material_text", "metallicFactor: must be a number", "/materials/0/pbrMetallicRoughness/metallicFactor", R"("1")"},
    {"material_texture", "normalTexture.index: 0 is out of range", "/materials/0/normalTexture", R"({"index":0})"},
    {"material_alpha", R"(alphaMode: "FOG")", "/materials/0/alphaMode", R"("FOG")"},
    {"camera_fov", "cameras[0].perspective.yfov: must be between", "/cameras/0/perspective/yfov", "0"},
    {"camera_type", "cameras[0].type: is not", "/cameras/0/type", R"("fisheye")"},
    {"camera_far", "zfar must be larger than znear", "/cameras/0/perspective/zfar", "0.05"},
    {"light_type", R"(lights[0].type: "laser")", "/extensions/KHR_lights_punctual/lights/0/type", R"("laser")"},
    {"light_negative", "lights[0].intensity: -1", "/extensions/KHR_lights_punctual/lights/0/intensity", "-1"},
    {"uri_parent", R"(buffers[0].uri: "../secret.bin" leaves the scene's folder)", "/buffers/0/uri", R"("../secret.bin")"},
    {"uri_encoded_parent", "leaves the scene's folder", "/buffers/0/uri", R"("%2e%2e/secret.bin")"},
    {"uri_absolute", "is an absolute path", "/buffers/0/uri", R"("/etc/passwd")"},
    {"uri_encoded_absolute", "is an absolute path", "/buffers/0/uri", R"("%2Fetc/passwd")"},
    {"uri_scheme", "is not a file beside the scene", "/buffers/0/uri", R"("file:///etc/passwd")"},
    {"uri_missing", R"("gone.bin" does not exist)", "/buffers/0/uri", R"("gone.bin")"},
    {"uri_folder", R"(buffers[0].uri: "." leaves the scene's folder)", "/buffers/0/uri", R"(".")"},
    {"uri_bad_escape", "is not a valid URI", "/buffers/0/uri", R"("a%zz")"},
    {"uri_none", "buffers[0]: has no uri", "/buffers/0/uri", ""},
    {"data_uri_short", "bufferViews[0]: bytes 0 to 36 are outside buffers[0] of 3 bytes", "/buffers/0/uri", R"("data:application/octet-stream;base64,AAAA")"},
    {"data_uri_text", "bufferViews[0]: bytes 0 to 36 are outside buffers[0] of 4 bytes", "/buffers/0/uri", R"("data:what/ever,AAAA")"},
    {"data_uri_digits", "buffers[0].uri: \"data:;base64,A!AA\" does not hold valid base64", "/buffers/0/uri", R"("data:;base64,A!AA")"},
    {"data_uri_cut", "does not hold valid base64", "/buffers/0/uri", R"("data:;base64,AAAAA")"},
    {"data_uri_padded_twice", "does not hold valid base64", "/buffers/0/uri", R"("data:;base64,AA==AA==")"},
    {"data_uri_comma", "is a data URI without a comma", "/buffers/0/uri", R"("data:;base64")"},
    {"uri_parent_after_folder", "leaves the scene's folder", "/buffers/0/uri", R"("sub/../../secret.bin")"},
    {"uri_parent_backslash", "does not exist", "/buffers/0/uri", R"("..\\secret.bin")"},
    // The views of whole_document's accessors bear the same numbers; 7 and 8 are the sparse one's indices and values.
    {"position_nan", "accessors[0]: as POSITION holds a value that is not finite, in element 1", "", "", 0, 16, {0, 0, 0xc0, 0x7f}},
    {"position_infinite", "accessors[0]: as POSITION holds a value", "", "", 0, 0, {0, 0, 0x80, 0xff}},
    {"weight_nan", "accessors[2]: as WEIGHTS_0 holds a value", "", "", 2, 0, {1, 0, 0x80, 0x7f}},
    {"index_too_large", "index 9 is outside its 3 vertices", "", "", 3, 4, {9, 0}},
    {"times_repeat", "key times are not strictly increasing", "", "", 4, 4, {0, 0, 0, 0}},
    {"times_negative", "has a negative key time", "", "", 4, 0, {0, 0, 0x80, 0xbf}},
    {"times_nan", "animation input holds a value that is not finite", "", "", 4, 4, {0, 0, 0xc0, 0x7f}},
    {"rotation_nan", "animation output holds a value that is not finite", "", "", 5, 0, {0, 0, 0xc0, 0x7f}},
    {"bind_matrix_nan", "as inverse bind matrices holds a value that is not finite", "", "", 6, 8, {0, 0, 0xc0, 0x7f}},
    {"sparse_index", "sparse.indices: index 9 is outside", "", "", 7, 1, {9}},
    {"sparse_order", "sparse.indices: are not strictly increasing", "", "", 7, 0, {2, 0}},
    {"sparse_nan", "accessors[7]: as POSITION holds a value that is not finite, in element 2", "", "", 8, 12, {0, 0, 0xc0, 0x7f}},
    // clang-format on
};

void spoil(GltfBuilder& b, const Case& one) {
  if (one.view >= 0) {
    const std::size_t start = b.doc["bufferViews"][one.view]["byteOffset"];
    std::memcpy(b.bytes.data() + start + one.offset, one.bytes.data(), one.bytes.size());
  }
  b.embed();
  const json::json_pointer pointer(one.pointer);
  if (pointer.empty()) return;
  if (*one.value != '\0') {
    b.doc[pointer] = json::parse(one.value);
  } else {
    b.doc[pointer.parent_pointer()].erase(pointer.back());
  }
}

class MalformedGltf : public testing::TestWithParam<Case> {};

TEST_P(MalformedGltf, IsRefusedByName) {
  GltfBuilder b = whole_document();
  spoil(b, GetParam());
  const TempFolder folder;
  const std::string path = folder.write("scene.gltf", b.text());
  try {
    // What only some renderings need is refused where it is chosen.
    const Scene scene = load_gltf(path);
    (void)select_animations(scene, "");
    for (const Camera& camera : scene.cameras)
      if (!camera.fault.empty()) throw Error(ErrorKind::input, camera.fault);
    FAIL() << "was loaded";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find(GetParam().expected), std::string::npos) << text;
    EXPECT_EQ(text.rfind(path, 0), 0u) << "does not begin with the file: " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_TRUE(error.kind() == ErrorKind::input || error.kind() == ErrorKind::limit);
  }
}

INSTANTIATE_TEST_SUITE_P(All, MalformedGltf, testing::ValuesIn(cases),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(WholeDocument, LoadsUnspoilt) {
  GltfBuilder b = whole_document();
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.text()));
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.nodes[0].skin, 0u);
}

// No room is made for elements that a file only claims.
TEST(MalformedGltfMemory, ElementsThatAreNotThereTakeNone) {
  GltfBuilder b;
  b.node_with({{"POSITION", b.accessor(std::vector<float>(9), FLOAT, "VEC3", 3)}});
  b.doc["accessors"][0]["count"] = 150'000'000;
  const TempFolder folder;
  const std::string path = folder.write("scene.gltf", b.text());
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &usual), 0);
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlimit tight{pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + (std::uint64_t{256} << 20),
                     usual.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &tight), 0);
  std::string reason;
  try {
    (void)load_gltf(path);
  } catch (const std::exception& error) {
    reason = error.what();
  }
  ASSERT_EQ(setrlimit(RLIMIT_AS, &usual), 0);
  EXPECT_NE(reason.find("accessors[0]: 150000000 elements end outside"), std::string::npos) << reason;
}

}  // namespace
}  // namespace sheaf
