// SPDX-License-Identifier: MIT
// What a file is that is no glTF, by its first bytes: who gives the wrong file is told which one it was.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>

namespace sheaf {

inline constexpr std::size_t file_kind_bytes = 4096;  // as much of a file's beginning as is ever looked at

namespace detail {

struct FileSignature {
  std::string_view bytes, kind;
};

// "what it is: what to do", the latter where it is not plain.
inline constexpr std::string_view export_it = ": export it as glTF 2.0 from the program that made it";

inline constexpr FileSignature file_signatures[] = {
    {"Kaydara FBX Binary", "a binary FBX file"},
    {"; FBX ", "an FBX file (ASCII)"},
    {"BLENDER", "a Blender file"},
    {"PXR-USDC", "a USD file (binary)"},
    {"#usda", "a USD file (text)"},
    {"ply\n", "a PLY file"},
    {"ply\r", "a PLY file"},
    {"Ogawa", "an Alembic file"},
    {"DRACO", "a bare Draco file"},
    {"#VRML", "a VRML file"},
    {"xof ", "a DirectX (.x) file"},
    {"PMX ", "a PMX file"},
    {"Pmd", "a PMD file"},
    {"MM\0*", "a TIFF image"},
    {"MM", "a 3DS file"},
    {"b3dm", "a 3D Tiles file (b3dm)"},
    {"i3dm", "a 3D Tiles file (i3dm)"},
    {"pnts", "a 3D Tiles file (pnts)"},
    {"cmpt", "a 3D Tiles file (cmpt)"},
    {"\x1f\x8b", "a gzip file: unpack it first"},
    {"BZh", "a bzip2 file: unpack it first"},
    {"\xfd"
     "7zXZ",
     "an xz file: unpack it first"},
    {"\x28\xb5\x2f\xfd", "a Zstandard file (Blender writes compressed .blend files so): unpack it first"},
    {"7z\xbc\xaf", "a 7-Zip archive: unpack it first"},
    {"Rar!", "a RAR archive: unpack it first"},
    {"\x89PNG", "a PNG image"},
    {"\xff\xd8\xff", "a JPEG image"},
    {"GIF8", "a GIF image"},
    {"\xabKTX", "a KTX image"},
    {"DDS ", "a DDS image"},
    {"8BPS", "a Photoshop image"},
    {"II*", "a TIFF image"},
    {"\x76\x2f\x31\x01", "an OpenEXR image"},
    {"#?RADIANCE", "a Radiance HDR image"},
    {"#?RGBE", "a Radiance HDR image"},
    {"RIFF", "a RIFF file (WebP, WAV or AVI)"},
    {"\x89HDF", "an HDF5 file"},
    {"%PDF", "a PDF document"},
    {"\x7f"
     "ELF",
     "a program (ELF)"},
    {"MZ", "a Windows program"},
    {"version https://git-lfs", "a Git LFS pointer, not the file that it stands for: fetch that with \"git lfs pull\""},
};

inline bool holds(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

inline std::string_view zip_kind(std::string_view head) {
  const std::string_view name = head.size() > 30 ? head.substr(30, 255) : std::string_view{};  // of the first entry
  if (holds(name, ".usdc") || holds(name, ".usda") || holds(name, ".usd")) return "a USDZ file";
  if (name.starts_with("[Content_Types].xml") || name.starts_with("3D/")) return "a 3MF or Office file";
  return "a ZIP archive: unpack it first";
}

inline std::string_view markup_kind(std::string_view head) {
  if (holds(head, "<COLLADA")) return "a Collada file";
  if (holds(head, "<X3D")) return "an X3D file";
  if (holds(head, "<svg")) return "an SVG image";
  if (holds(head, "<!DOCTYPE html") || holds(head, "<!doctype html") || holds(head, "<html"))
    return "an HTML page: the address that it was downloaded from leads to a page, not to the file";
  return "an XML or HTML file";
}

// The keyword of the first line that is neither empty nor a comment tells OBJ and its like from other text.
inline std::string_view text_kind(std::string_view head) {
  while (!head.empty()) {
    const std::size_t end = std::min(head.find_first_of("\r\n"), head.size());
    std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 1, head.size()));
    while (line.starts_with(' ') || line.starts_with('\t')) line.remove_prefix(1);
    if (line.empty() || line[0] == '#') continue;
    const std::string_view word = line.substr(0, line.find_first_of(" \t"));
    for (const std::string_view key : {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"})
      if (word == key) return "an OBJ file";
    if (word == "newmtl") return "an MTL file (an OBJ file's materials)";
    if (word == "OFF" || word == "COFF") return "an OFF file";
    if (word == "ISO-10303-21;") return "a STEP file";
    return {};
  }
  return {};
}

}  // namespace detail

/// "a PNG image"; empty for what is not known. `head` is the file's first file_kind_bytes, or all of a shorter one,
/// `size` its length. JSON and binary glTF are none of these.
[[nodiscard]] inline std::string file_kind(std::string_view head, std::size_t size) {
  using namespace detail;
  head = head.substr(0, file_kind_bytes);
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  const auto model = [](std::string_view kind) { return std::string(kind) + std::string(export_it); };
  if (head.starts_with("PK\x03\x04") || head.starts_with("PK\x05\x06")) {
    const std::string_view kind = zip_kind(head);
    return holds(kind, ":") ? std::string(kind) : model(kind);
  }
  for (const FileSignature& one : file_signatures) {
    if (!head.starts_with(one.bytes)) continue;
    const bool is_model = !holds(one.kind, ":") && !holds(one.kind, "image") && !holds(one.kind, "document") &&
                          !holds(one.kind, "program") && !holds(one.kind, "RIFF");
    return is_model ? model(one.kind) : std::string(one.kind);
  }
  if (head.size() > 84 && size >= 84) {  // a binary STL may begin with anything: its length tells
    std::size_t triangles = 0;
    for (int i = 3; i >= 0; --i)
      triangles = triangles << 8 | static_cast<unsigned char>(head[80 + static_cast<std::size_t>(i)]);
    if (triangles > 0 && size == 84 + 50 * triangles) return model("an STL file (binary)");
  }
  if (head.starts_with("solid") && holds(head, "facet")) return model("an STL file (text)");
  if (head.size() > 262 && head.substr(257, 5) == "ustar") return "a tar archive: unpack it first";
  if (head.starts_with("\xff\xfe") || head.starts_with("\xfe\xff")) return "UTF-16 text: glTF is UTF-8";
  if (holds(head, "FBXHeaderExtension")) return model("an FBX file (ASCII)");
  std::string_view text = head;
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
  if (text.starts_with('<')) {
    const std::string_view kind = markup_kind(text);
    return kind == "a Collada file" || kind == "an X3D file" ? model(kind) : std::string(kind);
  }
  if (holds(head, std::string_view("\0", 1))) return head.starts_with("BM") ? "a BMP image" : "";
  const std::string_view kind = text_kind(head);
  return kind.empty() ? "" : model(kind);
}

}  // namespace sheaf
