// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sheaf {

/// The folder a scene file lies in: the only place its URIs may lead to, and a budget for the bytes read from it.
class SceneFolder {
 public:
  SceneFolder(const std::string& scene_path, std::uint64_t byte_budget);

  [[nodiscard]] std::string path() const { return root_.string(); }
  [[nodiscard]] std::vector<std::uint8_t> read_scene();

  /// Checks every buffer's and image's URI: relative, inside the folder also after links, a file that is there and
  /// large enough. `binary_size` is the length of the .glb's BIN chunk. Throws Error{input}.
  void check_references(const nlohmann::json& document, std::uint64_t binary_size);

  [[nodiscard]] bool holds(const std::string& path) const;
  [[nodiscard]] std::uint64_t size_of(const std::string& path) const;  // as `read` gives it
  [[nodiscard]] std::vector<std::uint8_t> read(const std::string& path);

 private:
  [[noreturn]] void refuse(const std::string& place, const std::string& reason) const;
  void check_buffer_uri(const std::string& uri, std::uint64_t length, const std::string& place);
  std::filesystem::path checked_path(const std::string& uri, const std::string& place) const;
  std::vector<std::uint8_t> read_bounded(const std::filesystem::path& path, std::uint64_t most);

  std::string scene_path_;
  std::filesystem::path root_;  // canonical
  std::uint64_t left_;
  // Canonical paths of the files that the scene refers to, and how much of each it needs (a buffer's byteLength).
  std::map<std::filesystem::path, std::uint64_t> wanted_;
};

}  // namespace sheaf
