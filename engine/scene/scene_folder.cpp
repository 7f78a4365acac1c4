// SPDX-License-Identifier: MIT
#include "scene/scene_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/sha256.hpp"
#include "scene/data_uri.hpp"

namespace sheaf {
namespace {

namespace fs = std::filesystem;

bool has_scheme(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon != std::string_view::npos && name.substr(0, colon).find('/') == std::string_view::npos;
}

bool inside(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_relative(root);
  return !relative.empty() && *relative.begin() != ".." && relative != ".";
}

}  // namespace

SceneFolder::SceneFolder(const std::string& scene_path, std::uint64_t byte_budget)
    : scene_path_(scene_path), left_(byte_budget) {
  std::error_code error;
  const fs::path canonical = fs::canonical(scene_path, error);
  if (error) throw io_error(scene_path, error.message());
  // The folder that the name says, not the one where a link to the scene leads: its files lie beside the name.
  root_ = fs::canonical(fs::absolute(scene_path).parent_path(), error);
  if (error) throw io_error(scene_path, error.message());
  if (!fs::is_regular_file(canonical, error)) throw io_error(scene_path, "is not a file");
}

std::vector<std::uint8_t> SceneFolder::read_scene() {
  std::vector<std::uint8_t> bytes = read_bytes(scene_path_, std::numeric_limits<std::uint64_t>::max());
  scene_sha256_ = sha256_of(bytes);
  return bytes;
}

Located SceneFolder::locate(const std::string& uri) const {
  bool whole = true;
  const std::string shown = in_quotes(uri), name = percent_decoded(uri, whole);
  Located out = locate_name(name, shown);
  if (out.fault.empty()) {
    if (!whole) out.oddity = shown + " is not a valid URI, and is taken as a file's name";
    return out;
  }
  // Names that were never encoded, and those of Windows.
  std::string turned = name;
  std::ranges::replace(turned, '\\', '/');
  for (const std::string& other : {uri, turned}) {
    if (other == name) continue;
    Located found = locate_name(other, shown);
    if (!found.fault.empty()) continue;
    found.oddity = shown + " is not a valid URI, and is taken for " + in_quotes(other);
    return found;
  }
  if (!whole) out.fault = shown + " is not a valid URI";
  return out;
}

Located SceneFolder::locate_name(const std::string& name, const std::string& shown) const {
  const auto refused = [&](const std::string& reason) { return Located{{}, shown + " " + reason, {}}; };
  if (name.empty() || name.find('\0') != std::string::npos) return refused("is not a valid URI");
  if (has_scheme(name)) return refused("is not a file beside the scene");
  if (fs::path(name).is_absolute() || name.front() == '\\') return refused("is an absolute path");
  const fs::path plain = fs::path(name).lexically_normal();
  if (plain.empty() || *plain.begin() == ".." || plain == ".") return refused("leaves the scene's folder");
  std::error_code error;
  Located out;
  out.path = fs::weakly_canonical(root_ / plain, error);
  if (error) return refused("cannot be resolved: " + error.message());
  if (!inside(out.path, root_)) return refused("leaves the scene's folder");
  if (!fs::exists(out.path, error)) return refused("does not exist");
  if (!fs::is_regular_file(out.path, error)) return refused("is not a file");
  const auto climbs = [](const fs::path& path) { return std::ranges::find(path, fs::path("..")) != path.end(); };
  if (climbs(fs::path(name))) out.oddity = shown + " is read as " + in_quotes(plain.string());
  return out;
}

std::vector<std::uint8_t> SceneFolder::read(const fs::path& path, std::uint64_t most) {
  std::vector<std::uint8_t> bytes = read_bytes(path, most);
  sha256_of_[path.lexically_relative(root_).generic_string()] = sha256_of(bytes);
  return bytes;
}

std::string SceneFolder::sha256() const {
  if (sha256_of_.empty()) return scene_sha256_;
  std::string all = scene_sha256_ + "\n";
  for (const auto& [name, hash] : sha256_of_) all += hash + " " + name + "\n";
  return sha256_of(all);
}

std::vector<std::uint8_t> SceneFolder::read_bytes(const fs::path& path, std::uint64_t most) {
  std::error_code error;
  const std::uint64_t size = std::min<std::uint64_t>(fs::file_size(path, error), most);
  if (error) throw io_error(path.string(), error.message());
  if (size > left_) throw limit_error(scene_path_, "the scene's files are larger than allowed");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw io_error(path.string(), std::strerror(errno));
  std::vector<std::uint8_t> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uint64_t>(stream.gcount()) != size) throw io_error(path.string(), "could not be read whole");
  left_ -= size;
  return bytes;
}

}  // namespace sheaf
