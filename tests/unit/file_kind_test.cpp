// SPDX-License-Identifier: MIT
// Files that are no glTF, named as what they are.
#include "core/file_kind.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "gltf_builder.hpp"
#include "scene/gltf_loader.hpp"

namespace sheaf {
namespace {

using namespace test;

std::string reason(const std::string& bytes) {
  const TempFolder folder;
  try {
    (void)load_gltf(folder.write("m", bytes));
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "was loaded";
}

TEST(FileKind, IsNamed) {
  std::string stl(84 + 2 * 50, 'x');
  stl.replace(80, 4, std::string("\2\0\0\0", 4));
  std::string tar(512, '\0');
  tar.replace(257, 5, "ustar");
  const std::pair<std::string, const char*> files[] = {
      {std::string("Kaydara FBX Binary  \0\x1a\0", 23), "a binary FBX file: export it as glTF 2.0"},
      {"; FBX 7.4.0 project file\n", "an FBX file (ASCII)"},
      {"\n; made by hand\nFBXHeaderExtension:  {\n", "an FBX file (ASCII)"},
      {"# Blender\nmtllib a.mtl\no Cube\nv 1 2 3\n", "an OBJ file"},
      {"v 1 2 3\n", "an OBJ file"},
      {"\r\n  # x\r\nvn 0 0 1\r\n", "an OBJ file"},
      {"newmtl a\n", "an MTL file"},
      {"\x1f\x8b\x08", "a gzip file: unpack it first"},
      {"PK\x03\x04" + std::string(26, '\0') + "scene.gltf", "a ZIP archive: unpack it first"},
      {"PK\x03\x04" + std::string(26, '\0') + "scene.usdc", "a USDZ file"},
      {"#usda 1.0\n", "a USD file (text)"},
      {"PXR-USDC", "a USD file (binary)"},
      {"ply\nformat ascii 1.0\n", "a PLY file"},
      {"solid x\nfacet normal 0 0 1\n", "an STL file (text)"},
      {stl, "an STL file (binary)"},
      {"BLENDER-v300", "a Blender file"},
      {"\x28\xb5\x2f\xfd", "a Zstandard file"},
      {"<?xml version=\"1.0\"?>\n<COLLADA>", "a Collada file"},
      {"<!DOCTYPE html>", "an HTML page"},
      {"\xef\xbb\xbf<html>", "an HTML page"},
      {"<svg>", "an SVG image"},
      {"\x89PNG\r\n", "a PNG image"},
      {"\xff\xd8\xff\xe0", "a JPEG image"},
      {"version https://git-lfs.github.com/spec/v1\n", "a Git LFS pointer"},
      {tar, "a tar archive"},
      {std::string("\xff\xfe{\0", 4), "UTF-16 text"},
  };
  for (const auto& [bytes, kind] : files)
    EXPECT_NE(reason(bytes).find(std::string("is not a glTF file but ") + kind), std::string::npos)
        << kind << ": " << reason(bytes);
}

TEST(FileKind, OldGltfSaysHowToConvert) {
  EXPECT_NE(reason(std::string("glTF\1\0\0\0\x20\0\0\0\1\0\0\0\0\0\0\0", 20)).find("is binary glTF 1.0"),
            std::string::npos);
  const std::string text = reason(R"({"asset":{"version":"1.0"},"meshes":{"a":{}}})");
  EXPECT_NE(text.find("asset.version: \"1.0\" is not supported"), std::string::npos) << text;
  EXPECT_NE(text.find("gltf-pipeline"), std::string::npos) << text;
  EXPECT_NE(reason(R"({"meshes":{"a":{}}})").find("this is glTF 1.0"), std::string::npos);
}

TEST(FileKind, OtherJsonAndUnknownFiles) {
  EXPECT_NE(reason(R"({"camera_path":[]})").find("asset is missing: this is a camera path"), std::string::npos);
  EXPECT_NE(reason(R"({"metadata":{},"object":{}})").find("JSON of three.js"), std::string::npos);
  EXPECT_NE(reason("hello\nworld").find("is not a glTF file: it begins with \"hello\""), std::string::npos);
  EXPECT_NE(reason(std::string(300, '\x01')).find("is not a glTF file"), std::string::npos);
  EXPECT_NE(reason("\xef\xbb\xbf").find("is empty"), std::string::npos);
  EXPECT_EQ(file_kind("{\"asset\":{}}", 12), "");
}

}  // namespace
}  // namespace sheaf
