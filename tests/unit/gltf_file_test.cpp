// SPDX-License-Identifier: MIT
// Files that are wrong as files: no JSON, cut short, leading out of their folder, images that are none.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "gltf_builder.hpp"
#include "scene/gltf_loader.hpp"

namespace sheaf {
namespace {

using namespace test;

void expect_refused(const std::string& bytes, const std::string& expected) {
  const TempFolder folder;
  try {
    (void)load_gltf(folder.write("scene.glb", bytes));
    FAIL() << "was loaded, expected: " << expected;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
  }
}

TEST(MalformedFile, NotJson) {
  expect_refused("", "is empty");
  expect_refused("{", "is not valid JSON");
  expect_refused("[]", "document: must be an object");
  expect_refused("{\"asset\": 1e999}", "is not valid JSON");
  expect_refused(std::string(1'000'000, '['), "nests deeper");
  expect_refused("{\"extras\":" + std::string(500, '[') + std::string(500, ']') + "}", "nests deeper");
}

// Every truncation of a .glb, and every single byte of its headers set to 0xff. The header's own length says nothing
// that the chunks do not.
TEST(MalformedFile, GlbCutAndSpoilt) {
  GltfBuilder b = whole_document();
  const std::string whole = b.glb();
  const TempFolder folder;
  for (std::size_t size = 4; size < whole.size(); size += 1 + size / 40) {
    EXPECT_THROW((void)load_gltf(folder.write("cut.glb", whole.substr(0, size))), Error) << size;
  }
  for (std::size_t at = 4; at < 20; ++at) {
    std::string spoilt = whole;
    spoilt[at] = '\xff';
    const std::string path = folder.write("spoilt.glb", spoilt);
    if (at >= 8 && at < 12) {
      EXPECT_NE(load_gltf(path).warnings.at(0).find("its chunks end at"), std::string::npos) << at;
    } else {
      EXPECT_THROW((void)load_gltf(path), Error) << at;
    }
  }
}

TEST(MalformedFile, LinksOutOfTheFolderAreRefused) {
  const TempFolder outside, inside;
  GltfBuilder b = whole_document();
  (void)outside.write("data.bin", std::string(b.bytes.begin(), b.bytes.end()));
  std::filesystem::create_symlink(outside.path() / "data.bin", inside.path() / "data.bin");
  b.doc["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", "data.bin"}}};
  try {
    (void)load_gltf(inside.write("scene.gltf", b.doc.dump()));
    FAIL() << "was loaded";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("leaves the scene's folder"), std::string::npos) << error.what();
  }
}

TEST(MalformedFile, MissingSceneIsAnIoError) {
  try {
    (void)load_gltf("/nonexistent/scene.gltf");
    FAIL() << "was loaded";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
  }
}

// Images are looked at before they are decoded, and other formats are refused by name.
TEST(MalformedFile, Images) {
  const auto refused = [](const std::string& bytes, const std::string& expected) {
    GltfBuilder b = whole_document();
    b.add("images", {{"bufferView", b.view(std::vector<char>(bytes.begin(), bytes.end()))}, {"mimeType", "image/png"}});
    b.add("textures", {{"source", 0}});
    b.doc["materials"][0]["normalTexture"] = {{"index", 0}};
    expect_refused(b.text(), expected);
  };
  refused("\xabKTX 20\xbb\r\n\x1a\n", "images[0]: is a KTX2 file that is cut short");
  refused("GIF89a..........", "images[0]: GIF images are not supported");
  refused("\x89PNG\r\n\x1a\n", "images[0]: is not a valid PNG");
  // Data of more than 2 GiB, by its length: stb_image says no reason then.
  const char endless[] =
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\2\0\0\0\1\b\2\0\0\0\x7b\x40\xe8\xdd\xdd\0\0\x12IDAT\x01\x01\a\0";
  refused(std::string(endless, sizeof endless - 1), "images[0]: cannot be decoded: it is damaged");
  // A header of 1 x 1 texels, then texels of 1 GiB of which there is nothing.
  const char claims[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\0\0\0\0\x3a\x7e\x9b\x55\x40\0\0\0IDAT\x78";
  refused(std::string(claims, sizeof claims - 1), "images[0]: cannot be decoded: it is damaged");
  refused("nothing at all", "images[0]: unknown images are not supported");
}

}  // namespace
}  // namespace sheaf
