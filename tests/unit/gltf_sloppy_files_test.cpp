// SPDX-License-Identifier: MIT
// Files whose names, chunks or text break a rule of form and have one meaning: read, with a warning that names the
// place.
#include "core/error.hpp"
#include "gltf_support.hpp"

namespace sheaf {
namespace {

using namespace test;

// Two buffers of different length in one file: each has its bytes.
TEST(SloppyGltfFiles, OneFileOfTwoLengths) {
  GltfBuilder b = whole_document();
  const TempFolder folder;
  (void)folder.write("data.bin", std::string(b.bytes.begin(), b.bytes.end()) + "and more");
  b.doc["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", "data.bin"}}, {{"byteLength", 36}, {"uri", "data.bin"}}};
  b.doc["bufferViews"][0]["buffer"] = 1;
  const Scene scene = load_gltf(folder.write("scene.gltf", b.doc.dump()));
  expect_triangle(scene);
  EXPECT_TRUE(scene.warnings.empty()) << all_of(scene.warnings);
}

TEST(SloppyGltfFiles, NamesInsideTheFolder) {
  GltfBuilder b = whole_document();
  const TempFolder folder, outside;
  const std::string bytes(b.bytes.begin(), b.bytes.end());
  for (const char* name : {"data.bin", "sub/data.bin", "100%.bin", "a%20b.bin", "ä ö.bin"})
    (void)folder.write(name, bytes);
  (void)outside.write("data.bin", bytes);
  std::filesystem::create_directory_symlink(outside.path(), folder.path() / "link");
  const auto load = [&](const std::string& uri) {
    b.doc["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", uri}}};
    return load_gltf(folder.write("scene.gltf", b.doc.dump()));
  };
  for (const char* uri : {"sub/../data.bin", "none/../data.bin", "sub/%2e%2e/data.bin", "link/../data.bin"})
    EXPECT_TRUE(warns(load(uri), "is read as \"data.bin\"")) << uri;
  EXPECT_TRUE(load("./sub/./data.bin").warnings.empty());
  EXPECT_TRUE(load("%C3%A4%20%C3%B6.bin").warnings.empty());
  EXPECT_TRUE(load("ä ö.bin").warnings.empty());
  for (const char* uri : {"100%.bin", "a%20b.bin", "sub\\data.bin"})
    EXPECT_TRUE(warns(load(uri), "is not a valid URI")) << uri;
  for (const char* uri : {"link/data.bin", "sub/../../data.bin", "sub/../link/data.bin", "..\\data.bin",
                          "link\\data.bin", "%2e%2e/data.bin", "..%2fdata.bin", "sub/..%2f..%2fdata.bin"})
    EXPECT_THROW((void)load(uri), Error) << uri;
}

// Chunks in a .glb: payloads as they are given, each with its length.
std::string glb_of(const std::vector<std::pair<std::string, std::string>>& chunks, int length_error = 0) {
  const auto word = [](std::size_t value) {
    std::string out;
    for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i) & 255);
    return out;
  };
  std::string body;
  for (const auto& [type, bytes] : chunks) body += word(bytes.size()) + type + bytes;
  return "glTF" + word(2) + word(static_cast<std::size_t>(static_cast<int>(12 + body.size()) + length_error)) + body;
}

TEST(SloppyGlb, Chunks) {
  GltfBuilder with_uri = whole_document(), with_chunk = whole_document();
  const auto padded = [](std::string text, char with) {
    text.resize((text.size() + 3) / 4 * 4, with);
    return text;
  };
  const std::string json = padded(with_uri.text(), ' ');
  const std::string bin_type("BIN\0", 4);
  with_chunk.doc["buffers"] = {{{"byteLength", with_chunk.bytes.size()}}};
  const std::string short_json = with_chunk.doc.dump();
  const std::string binary = padded(std::string(with_chunk.bytes.begin(), with_chunk.bytes.end()), '\0');
  const TempFolder folder;
  const auto loads = [&](const std::string& glb, const std::string& warning) {
    const Scene scene = load_gltf(folder.write("scene.glb", glb));
    expect_triangle(scene);
    const bool right = warning.empty() ? scene.warnings.empty() : warns(scene, warning);
    EXPECT_TRUE(right) << warning << ": " << all_of(scene.warnings);
  };
  loads(glb_of({{"JSON", json}, {bin_type, ""}}), "");
  loads(glb_of({{"JSON", json}, {"TEST", "12345678"}}), "");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {"TEST", "1234"}, {bin_type, binary}}), "");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {bin_type, binary}, {"TEST", "1234"}}), "");
  loads(glb_of({{bin_type, binary}, {"JSON", padded(short_json, ' ')}}), "stands before the JSON chunk");
  loads(glb_of({{"JSON", padded(short_json, '\0') + std::string(4, '\0')}, {bin_type, binary}}), "padded with zeros");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {bin_type, binary}, {bin_type, "1234"}}), "second BIN chunk");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {bin_type, binary}}) + "rest", "4 bytes after the end");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {bin_type, binary}}, 4), "its chunks end at");
  loads(glb_of({{"JSON", padded(short_json, ' ')}, {bin_type, binary}}, -4), "its chunks end at");
}

TEST(SloppyText, ByteOrderMark) {
  GltfBuilder b = whole_document();
  const TempFolder folder;
  const Scene scene = load_gltf(folder.write("scene.gltf", "\xef\xbb\xbf" + b.text()));
  expect_triangle(scene);
  EXPECT_TRUE(warns(scene, "byte order mark"));
}

}  // namespace
}  // namespace sheaf
