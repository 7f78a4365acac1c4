// SPDX-License-Identifier: MIT
// Taking uploads apart: multipart bodies, file names.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "upload/archive_names.hpp"
#include "upload/multipart.hpp"
#include "upload/safe_path.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

struct Part {
  std::string name, filename, type, data;
  bool operator==(const Part&) const = default;
};

std::vector<Part> parse(const std::string& body, std::size_t piece, std::uint64_t max_parts = 100) {
  std::vector<Part> parts;
  bool open = false;
  MultipartParser parser("b", max_parts,
                         {[&](const PartHeader& header) {
                            EXPECT_FALSE(open);
                            open = true;
                            parts.push_back({header.name, header.filename.value_or("-"), header.content_type, ""});
                          },
                          [&](std::string_view data) { parts.back().data += data; }, [&] { open = false; }});
  for (std::size_t at = 0; at < body.size(); at += piece) parser.feed(std::string_view(body).substr(at, piece));
  parser.finish();
  EXPECT_FALSE(open);
  return parts;
}

std::string part(const std::string& disposition, const std::string& data) {
  return "--b\r\nContent-Disposition: form-data; " + disposition + "\r\n\r\n" + data + "\r\n";
}

TEST(Multipart, GivesTheSamePartsWhateverThePieces) {
  const std::string tricky = "\r\n--\r\n--a\r\n-b\r--b\n--b\r\n--B";  // nearly the delimiter, many times
  const std::string body =
      "preamble\r\n" + part("name=\"scene\"; filename=\"a b.glb\"", tricky) +
      "--b \t\r\ncontent-type: Model/X; y=1\r\nX-Other: z\r\nCONTENT-DISPOSITION: form-data;name=plain"
      "\r\n\r\n\r\n" +
      part("name=\"n\"; filename=\"\"", "last") + "--b--\r\nepilogue --b\r\n";
  const std::vector<Part> expected{
      {"scene", "a b.glb", "", tricky}, {"plain", "-", "model/x", ""}, {"n", "", "", "last"}};
  for (std::size_t piece = 1; piece < body.size() + 1; ++piece) EXPECT_EQ(parse(body, piece), expected) << piece;
}

TEST(Multipart, RefusesWhatIsMalformed) {
  const std::string good = part("name=\"a\"", "x");
  EXPECT_EQ(parse(good + "--b--", 3).size(), 1u);
  for (const std::string& body : std::vector<std::string>{
           "", "x", good, good + "--b-", good + "--bx\r\n", good + "--b\rx\n", "--b\r\n\r\nx\r\n--b--",
           part("filename=\"a\"", "x") + "--b--", part("name=\"", "x") + "--b--",
           part("name=\"a\" filename=\"b\"", "x") + "--b--", part("name=\"a\"; name=\"b\"", "x") + "--b--",
           part("name", "x") + "--b--", part("name=\"a\"; filename*=latin1''x", "") + "--b--",
           part("name=\"a\"; filename*=UTF-8''%4", "") + "--b--",
           "--b\r\nContent-Disposition: attachment; name=\"a\"\r\n\r\nx\r\n--b--",
           "--b\r\nContent-Disposition: form-data; name=\"a\"\r\nContent-Disposition: form-data; "
           "name=\"a\"\r\n\r\nx\r\n--b--",
           "--b\r\nno header\r\n\r\nx\r\n--b--", "--b\r\nX: " + std::string(9000, 'x')})
    EXPECT_THROW((void)parse(body, 5), Problem) << body.substr(0, 100);
  EXPECT_THROW((void)parse(good + good + good + "--b--", 5, 2), Problem);
}

TEST(Multipart, ReadsFileNamesAsClientsWriteThem) {
  const auto filename = [](const std::string& parameter) {
    return parse(part("name=\"f\"; " + parameter, "") + "--b--", 1000)[0].filename;
  };
  EXPECT_EQ(filename("filename=\"a \\\"b\\\" \\\\ c\""), "a \"b\" \\ c");
  EXPECT_EQ(filename("filename=\"C:\\dir\\x\""), "C:\\dir\\x");
  EXPECT_EQ(filename("filename=\"old\"; filename*=utf-8'en'na%C3%AFve%20x"), "na\xc3\xafve x");
  EXPECT_EQ(filename("filename=token.bin"), "token.bin");
  EXPECT_EQ(filename("filename=\"a;b\""), "a;b");
}

TEST(Multipart, FindsTheBoundary) {
  EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Form-Data ; charset=utf-8; BOUNDARY=\"a b:c\""), "a b:c");
  EXPECT_EQ(multipart_boundary("application/json"), std::nullopt);
  EXPECT_EQ(multipart_boundary(""), std::nullopt);
  for (const std::string& type : std::vector<std::string>{"multipart/form-data", "multipart/form-data; boundary=",
                                                          "multipart/form-data; boundary=" + std::string(71, 'x')})
    EXPECT_THROW((void)multipart_boundary(type), Problem) << type;
}

TEST(SafePath, StaysInsideItsFolder) {
  EXPECT_EQ(safe_relative_path("textures/wood grain.png"), "textures/wood grain.png");
  EXPECT_EQ(safe_relative_path("...x/..y"), "...x/..y");
  EXPECT_EQ(safe_relative_path("textures\\wood.png"), "textures/wood.png");
  EXPECT_EQ(safe_relative_path("./a/./b"), "a/b");
  for (const std::string& path : std::vector<std::string>{"",
                                                          "/",
                                                          "/a",
                                                          "a/",
                                                          "a//b",
                                                          ".",
                                                          "./",
                                                          "..",
                                                          "a/..",
                                                          "../a",
                                                          "a\\..\\b",
                                                          "\\a",
                                                          "\\\\host\\a",
                                                          "C:\\a",
                                                          "c:/a",
                                                          "c:a",
                                                          "a\nb",
                                                          std::string("a\0b", 3),
                                                          "a\x7f",
                                                          std::string(256, 'x'),
                                                          std::string(2000, '/')})
    EXPECT_THROW((void)safe_relative_path(path), Problem) << path.substr(0, 50);
  std::string deep = "0";
  for (int i = 1; i < 16; ++i) deep += "/" + std::to_string(i);
  EXPECT_EQ(safe_relative_path(deep), deep);
  EXPECT_THROW((void)safe_relative_path(deep + "/16"), Problem);
}

TEST(Archives, LeaveOutWhatFileManagersAdd) {
  for (const std::string& name :
       std::vector<std::string>{"__MACOSX/model/._a.gltf", "__MACOSX/", "a/__MACOSX/b", "._a.gltf", "a/._b", "a\\._b",
                                ".DS_Store", "a/.DS_Store", "a/Icon\r", "Thumbs.db", "a/thumbs.db", "a/Desktop.ini"})
    EXPECT_TRUE(is_file_manager_metadata(name)) << name;
  for (const std::string& name : std::vector<std::string>{"a.gltf", "a/", "", "MACOSX/a", "a_.gltf", "._a/b",
                                                          "x.DS_Store", "__MACOSX", "icon", "_a"})
    EXPECT_EQ(is_file_manager_metadata(name), name == "__MACOSX") << name;
}

TEST(Archives, HaveOneSceneWhoseFolderHoldsTheOthers) {
  EXPECT_EQ(find_scene({"a.gltf"}), "a.gltf");
  EXPECT_EQ(find_scene({"x/y/z/a.glb"}), "x/y/z/a.glb");
  EXPECT_EQ(find_scene({"b/c.gltf", "a.gltf", "b/d.gltf"}), "a.gltf");
  EXPECT_EQ(find_scene({"x/old/a.gltf", "x/a.gltf"}), "x/a.gltf");
  for (const std::vector<std::filesystem::path>& scenes : std::vector<std::vector<std::filesystem::path>>{
           {}, {"a.gltf", "a.glb"}, {"x/a.gltf", "y/a.gltf"}, {"x/a.gltf", "xy/z/a.gltf"}, {"x/a.gltf", "y/z/a.gltf"}})
    EXPECT_THROW((void)find_scene(scenes), Problem);
}

TEST(SafePath, TakesNamesApart) {
  EXPECT_EQ(base_name("C:\\a\\b.glb"), "b.glb");
  EXPECT_EQ(base_name("/x/y"), "y");
  EXPECT_EQ(extension_of("a.b.GLB"), ".glb");
  EXPECT_EQ(extension_of("a"), "");
}

}  // namespace
}  // namespace sheaf::server
