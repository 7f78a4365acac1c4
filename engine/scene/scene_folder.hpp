// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sheaf {

/// Where a URI leads.
struct Located {
  std::filesystem::path path;  // canonical
  std::string fault;           // why it cannot be followed; empty: it can
  std::string oddity;          // what is unusual about it though it can be followed
};

/// The folder a scene file lies in: the only place its URIs may lead to, and a budget for the bytes read from it.
class SceneFolder {
 public:
  SceneFolder(const std::string& scene_path, std::uint64_t byte_budget);

  [[nodiscard]] std::vector<std::uint8_t> read_scene();

  /// The file that a relative URI names: inside the folder also after links, and there. ".." is taken out of the name
  /// as RFC 3986 (5.2.4) does, before any file is looked at.
  [[nodiscard]] Located locate(const std::string& uri) const;

  /// The first `most` bytes of a located file, or all of a shorter one.
  [[nodiscard]] std::vector<std::uint8_t> read(const std::filesystem::path& path, std::uint64_t most);

  /// SHA-256 of all that was read: the scene file's own where it is all there is.
  [[nodiscard]] std::string sha256() const;

 private:
  [[nodiscard]] std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path, std::uint64_t most);
  [[nodiscard]] Located locate_name(const std::string& name, const std::string& shown) const;

  std::string scene_path_;
  std::filesystem::path root_;  // canonical
  std::uint64_t left_;
  std::string scene_sha256_;
  std::map<std::string, std::string> sha256_of_;  // of what was read beside the scene, by path within the folder
};

}  // namespace sheaf
