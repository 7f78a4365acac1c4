// SPDX-License-Identifier: MIT
// Small glTF files written by the tests themselves: a document to change at will, and bytes behind its accessors.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sheaf::test {

enum : int { BYTE = 5120, UBYTE = 5121, SHORT = 5122, USHORT = 5123, UINT = 5125, FLOAT = 5126 };

inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = std::uint32_t{bytes[i]} << 16;
    if (i + 1 < bytes.size()) word |= std::uint32_t{bytes[i + 1]} << 8;
    if (i + 2 < bytes.size()) word |= bytes[i + 2];
    out += digits[word >> 18];
    out += digits[word >> 12 & 63];
    out += i + 1 < bytes.size() ? digits[word >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? digits[word & 63] : '=';
  }
  return out;
}

/// A folder of its own for each object, removed with it.
class TempFolder {
 public:
  TempFolder() {
    static int counter = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("sheaf-test-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() { std::filesystem::remove_all(path_); }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return (path_ / name).string();
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct GltfBuilder {
  nlohmann::json doc = {{"asset", {{"version", "2.0"}}}};
  std::vector<std::uint8_t> bytes;

  template <class T>
  int view(const std::vector<T>& data, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", data.size() * sizeof(T)}};
    if (stride > 0) view["byteStride"] = stride;
    const std::size_t at = bytes.size();
    bytes.resize(at + data.size() * sizeof(T));
    std::memcpy(bytes.data() + at, data.data(), data.size() * sizeof(T));
    return add("bufferViews", view);
  }
  template <class T>
  int accessor(const std::vector<T>& data, int component, const char* type, std::size_t width,
               bool normalized = false) {
    nlohmann::json accessor = {
        {"bufferView", view(data)}, {"componentType", component}, {"type", type}, {"count", data.size() / width}};
    if (normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }
  int add(const char* collection, const nlohmann::json& object) {
    doc[collection].push_back(object);
    return static_cast<int>(doc[collection].size()) - 1;
  }
  /// A node with a mesh of one primitive, in a scene.
  int node_with(const nlohmann::json& attributes, const nlohmann::json& more = nlohmann::json::object()) {
    nlohmann::json primitive = more;
    primitive["attributes"] = attributes;
    const int mesh = add("meshes", {{"primitives", {primitive}}});
    return add("nodes", {{"mesh", mesh}});
  }

  void embed() {
    if (doc.contains("buffers") || bytes.empty()) return;
    doc["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  }
  [[nodiscard]] std::string text() {
    embed();
    return doc.dump();
  }
  [[nodiscard]] std::string glb() {
    if (!bytes.empty()) doc["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string json = doc.dump();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::vector<std::uint8_t> binary = bytes;
    binary.resize((binary.size() + 3) / 4 * 4);
    std::string out = "glTF";
    const auto word = [&](std::size_t value) {
      for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i) & 255);
    };
    word(2);
    word(12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size()));
    word(json.size());
    out += "JSON" + json;
    if (binary.empty()) return out;
    word(binary.size());
    out += std::string("BIN\0", 4) + std::string(binary.begin(), binary.end());
    return out;
  }
};

inline const std::vector<float> unit_triangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

// Accessors: 0 positions, 1 joints, 2 weights, 3 indices, 4 times, 5 rotations, 6 inverse bind matrices, 7 sparse.
// Nodes: 0 the skinned mesh with a camera and a light, 1 and 2 the joints, 2 under 1.
inline GltfBuilder whole_document() {
  GltfBuilder b;
  b.accessor(unit_triangle, FLOAT, "VEC3", 3);
  b.accessor<std::uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, UBYTE, "VEC4", 4);
  b.accessor<float>({1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0}, FLOAT, "VEC4", 4);
  b.accessor<std::uint16_t>({0, 1, 2}, USHORT, "SCALAR", 1);
  b.accessor<float>({0, 1}, FLOAT, "SCALAR", 1);
  b.accessor<float>({0, 0, 0, 1, 0, 0, 1, 0}, FLOAT, "VEC4", 4);
  std::vector<float> identities(32, 0.0f);
  for (const std::size_t i : {0, 5, 10, 15, 16, 21, 26, 31}) identities[i] = 1;
  b.accessor(identities, FLOAT, "MAT4", 16);
  b.add("accessors", {{"componentType", FLOAT},
                      {"type", "VEC3"},
                      {"count", 3},
                      {"sparse",
                       {{"count", 2},
                        {"indices", {{"bufferView", b.view<std::uint8_t>({0, 2})}, {"componentType", UBYTE}}},
                        {"values", {{"bufferView", b.view<float>({1, 0, 0, 0, 1, 0})}}}}}});
  b.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}}}});
  b.node_with({{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}},
              {{"indices", 3}, {"material", 0}, {"targets", {{{"POSITION", 7}}}}});
  b.add("nodes", {{"children", {2}}});
  b.add("nodes", nlohmann::json::object());
  b.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", 6}});
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.doc["nodes"][0].update({{"skin", 0}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.add("scenes", {{"nodes", {0, 1}}});
  b.add("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}},
                       {"samplers", {{{"input", 4}, {"output", 5}}}}});
  return b;
}

}  // namespace sheaf::test
