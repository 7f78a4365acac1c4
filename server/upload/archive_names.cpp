// SPDX-License-Identifier: MIT
#include "upload/archive_names.hpp"

#include <algorithm>
#include <array>

#include "core/quote.hpp"
#include "http/message.hpp"
#include "upload/safe_path.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw Problem(ProblemKind::bad_scene, "zip: " + why); }

std::ptrdiff_t depth_of(const std::filesystem::path& path) { return std::distance(path.begin(), path.end()); }

bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

bool is_file_manager_metadata(std::string_view name) {
  static constexpr std::array<std::string_view, 4> files{".DS_Store", "Icon\r", "Thumbs.db", "desktop.ini"};
  while (true) {
    const auto end = name.find_first_of("/\\");
    const std::string_view part = name.substr(0, end);
    if (part == "__MACOSX") return true;
    if (end == std::string_view::npos)
      return part.starts_with("._") ||
             std::ranges::any_of(files, [&](std::string_view file) { return equal_ignoring_case(part, file); });
    name.remove_prefix(end + 1);
  }
}

bool is_scene_name(const std::filesystem::path& path) {
  const std::string extension = extension_of(path.filename().string());
  return extension == ".glb" || extension == ".gltf";
}

std::filesystem::path find_scene(std::vector<std::filesystem::path> scenes) {
  if (scenes.empty()) refuse("it contains no .glb or .gltf file");
  std::ranges::sort(scenes, [](const auto& a, const auto& b) {
    return depth_of(a) != depth_of(b) ? depth_of(a) < depth_of(b) : a < b;
  });
  const std::filesystem::path& first = scenes.front();
  const std::filesystem::path folder = first.parent_path();
  for (auto other = scenes.begin() + 1; other != scenes.end(); ++other)
    if (other->parent_path() == folder || !lies_in(*other, folder))
      refuse("it contains several scenes: '" + quote(first.string()) + "', '" + quote(other->string()) + "'");
  return first;
}

}  // namespace sheaf::server
