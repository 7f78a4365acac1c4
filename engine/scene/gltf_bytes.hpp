// SPDX-License-Identifier: MIT
// The bytes behind a glTF file's buffers, views and images, read when they are first asked for: what nothing uses is
// never opened.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene_folder.hpp"

namespace sheaf {

struct GltfFile;

struct BufferView {
  std::span<const std::uint8_t> bytes;
  std::uint64_t offset = 0;  // of the bytes in their buffer
  std::uint64_t stride = 0;  // between elements; 0: they follow each other
};

class GltfBytes {
 public:
  /// `binary` lies in `scene_bytes`.
  GltfBytes(SceneFolder folder, std::vector<std::uint8_t> scene_bytes, std::span<const std::uint8_t> binary)
      : folder_(std::move(folder)), scene_bytes_(std::move(scene_bytes)), binary_(binary) {}

  /// A bufferView, decompressed where an extension compresses it: a buffer that holds the same uncompressed is never
  /// opened. Its buffer may hold more or fewer bytes than it says, as long as the view lies inside.
  [[nodiscard]] BufferView view(const GltfFile& file, std::size_t index);

  /// An image's encoded bytes.
  [[nodiscard]] std::span<const std::uint8_t> image(const GltfFile& file, std::size_t index);

  /// SHA-256 of the scene file and of what has been read beside it.
  [[nodiscard]] std::string sha256() const { return folder_.sha256(); }

  /// Warns of buffers, views and images that could not be read, though nothing needs them.
  void report_unused(const GltfFile& file) const;

 private:
  struct Resource {
    std::vector<std::uint8_t> own;        // unless it lies in the scene file
    std::span<const std::uint8_t> bytes;  // of `own`, or of the scene file
  };
  [[nodiscard]] std::span<const std::uint8_t> buffer(const GltfFile& file, std::size_t index);
  [[nodiscard]] std::vector<std::uint8_t> from_uri(const GltfFile& file, const std::string& uri,
                                                   const std::string& place, std::uint64_t most);
  [[nodiscard]] std::span<const std::uint8_t> range(const GltfFile& file, const nlohmann::json& object,
                                                    const std::string& place, bool is_new);
  void find_reach(const GltfFile& file);
  void report_uri(const GltfFile& file, const std::string& collection, std::size_t index) const;

  SceneFolder folder_;
  std::vector<std::uint8_t> scene_bytes_;
  std::span<const std::uint8_t> binary_;
  std::map<std::size_t, Resource> buffers_, images_;           // by index, those that were asked for
  std::map<std::size_t, std::vector<std::uint8_t>> unpacked_;  // compressed views by index, those asked for
  std::uint64_t unpack_budget_ = 0;                            // bytes that further ones may have
  std::set<std::size_t> views_;
  std::vector<std::uint64_t> reach_;
};

}  // namespace sheaf
