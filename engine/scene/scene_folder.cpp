// SPDX-License-Identifier: MIT
#include "scene/scene_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include "core/error.hpp"

namespace sheaf {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// RFC 3986 percent-decoding; empty where an escape is malformed.
std::string percent_decoded(std::string_view uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      out += uri[i];
      continue;
    }
    if (i + 2 >= uri.size() || hex_digit(uri[i + 1]) < 0 || hex_digit(uri[i + 2]) < 0) return {};
    out += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
    i += 2;
  }
  return out;
}

bool has_scheme(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon != std::string_view::npos && name.substr(0, colon).find('/') == std::string_view::npos;
}

bool climbs(const fs::path& name) {
  for (const fs::path& part : name) {
    if (part == "..") return true;
  }
  return false;
}

std::string shown(const std::string& uri) {  // one printable line of bounded length
  std::string out = uri.substr(0, 80);
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return "\"" + out + (uri.size() > 80 ? "...\"" : "\"");
}

bool inside(const fs::path& path, const fs::path& root) {
  const fs::path relative = path.lexically_relative(root);
  return !relative.empty() && *relative.begin() != ".." && relative != ".";
}

// The types that tinygltf decodes; anything else in a data URI is refused here, by name.
bool known_data_uri(std::string_view uri) {
  for (const char* type : {"application/octet-stream", "application/gltf-buffer", "image/png", "image/jpeg",
                           "image/bmp", "image/gif", "text/plain"}) {
    if (uri.starts_with("data:" + std::string(type) + ";base64,")) return true;
  }
  return false;
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
  return read_bounded(scene_path_, std::numeric_limits<std::uint64_t>::max());
}

fs::path SceneFolder::checked_path(const std::string& uri, const std::string& place) const {
  const auto refuse = [&](const std::string& reason) -> Error {
    return input_error(scene_path_ + ": " + place, shown(uri) + " " + reason);
  };
  const std::string name = percent_decoded(uri);
  if (name.empty() || name.find('\0') != std::string::npos) throw refuse("is not a valid URI");
  if (has_scheme(name)) throw refuse("is not a file beside the scene");
  if (fs::path(name).is_absolute() || name.front() == '\\') throw refuse("is an absolute path");
  if (climbs(name)) throw refuse("leaves the scene's folder");
  std::error_code error;
  const fs::path path = fs::weakly_canonical(root_ / name, error);
  if (error) throw refuse("cannot be resolved: " + error.message());
  if (!inside(path, root_)) throw refuse("leaves the scene's folder");
  if (!fs::exists(path, error)) throw refuse("does not exist");
  if (!fs::is_regular_file(path, error)) throw refuse("is not a file");
  return path;
}

void SceneFolder::check_references(const nlohmann::json& document, std::uint64_t binary_size) {
  static const nlohmann::json nothing = nlohmann::json::array();
  const auto list = [&](const char* key) -> const nlohmann::json& {
    return document.contains(key) ? document.at(key) : nothing;
  };
  std::size_t i = 0;
  for (const auto& buffer : list("buffers")) {
    const std::string place = "buffers[" + std::to_string(i++) + "]";
    const auto length = buffer.at("byteLength").get<std::uint64_t>();
    if (!buffer.contains("uri")) {
      if (i == 1 && length <= binary_size) continue;
      const std::string reason = i > 1 || binary_size == 0
                                     ? "has no uri"
                                     : "is longer than the BIN chunk of " + std::to_string(binary_size) + " bytes";
      throw input_error(scene_path_ + ": " + place, reason);
    }
    const std::string uri = buffer.at("uri");
    if (uri.starts_with("data:")) {
      if (!known_data_uri(uri))
        throw input_error(scene_path_ + ": " + place + ".uri",
                          shown(uri.substr(0, 40)) + " is not a supported data URI");
      continue;
    }
    const fs::path path = checked_path(uri, place + ".uri");
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    if (error || size < length) {
      throw input_error(scene_path_ + ": " + place, shown(uri) + " has " + std::to_string(size) +
                                                        " bytes, byteLength says " + std::to_string(length));
    }
    if (!wanted_.emplace(path, length).second && wanted_[path] != length) {
      throw input_error(scene_path_ + ": " + place, shown(uri) + " is used by two buffers of different byteLength");
    }
  }
  i = 0;
  for (const auto& image : list("images")) {
    const std::string place = "images[" + std::to_string(i++) + "].uri";
    if (!image.contains("uri")) continue;
    const std::string uri = image.at("uri");
    if (!uri.starts_with("data:")) {
      wanted_.emplace(checked_path(uri, place), std::numeric_limits<std::uint64_t>::max());
    } else if (!known_data_uri(uri)) {
      throw input_error(scene_path_ + ": " + place, shown(uri.substr(0, 40)) + " is not a supported data URI");
    }
  }
}

bool SceneFolder::holds(const std::string& path) const {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  return !error && wanted_.contains(canonical);
}

std::uint64_t SceneFolder::size_of(const std::string& path) const {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(path, error);
  const auto found = wanted_.find(canonical);
  const std::uint64_t size = fs::file_size(canonical, error);
  return error || found == wanted_.end() ? 0 : std::min(size, found->second);
}

std::vector<std::uint8_t> SceneFolder::read(const std::string& path) {
  const fs::path canonical = fs::weakly_canonical(path);
  const auto found = wanted_.find(canonical);
  if (found == wanted_.end()) throw input_error(path, "is not a file of the scene");
  return read_bounded(canonical, found->second);
}

std::vector<std::uint8_t> SceneFolder::read_bounded(const fs::path& path, std::uint64_t most) {
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
