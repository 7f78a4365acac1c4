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

// Bytes that a data URI's base64 stands for.
std::uint64_t decoded_length(std::string_view uri) {
  std::string_view digits = uri.substr(uri.find(',') + 1);
  while (digits.ends_with('=')) digits.remove_suffix(1);
  return std::uint64_t{digits.size()} * 3 / 4;
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
  const auto require = [&](bool right, const std::string& reason) {
    if (!right) refuse(place, shown(uri) + " " + reason);
  };
  const std::string name = percent_decoded(uri);
  require(!name.empty() && name.find('\0') == std::string::npos, "is not a valid URI");
  require(!has_scheme(name), "is not a file beside the scene");
  require(!fs::path(name).is_absolute() && name.front() != '\\', "is an absolute path");
  require(!climbs(name), "leaves the scene's folder");
  std::error_code error;
  const fs::path path = fs::weakly_canonical(root_ / name, error);
  require(!error, "cannot be resolved: " + error.message());
  require(inside(path, root_), "leaves the scene's folder");
  require(fs::exists(path, error), "does not exist");
  require(fs::is_regular_file(path, error), "is not a file");
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
    if (buffer.contains("uri")) {
      check_buffer_uri(buffer.at("uri").get_ref<const std::string&>(), length, place);
    } else if (i > 1 || binary_size == 0) {
      refuse(place, "has no uri");
    } else if (length > binary_size) {
      refuse(place, "is longer than the BIN chunk of " + std::to_string(binary_size) + " bytes");
    }
  }
  i = 0;
  for (const auto& image : list("images")) {
    const std::string place = "images[" + std::to_string(i++) + "].uri";
    if (!image.contains("uri")) continue;
    const auto& uri = image.at("uri").get_ref<const std::string&>();
    if (!uri.starts_with("data:")) {
      wanted_.emplace(checked_path(uri, place), std::numeric_limits<std::uint64_t>::max());
    } else if (!known_data_uri(uri)) {
      refuse(place, shown(uri.substr(0, 40)) + " is not a supported data URI");
    }
  }
}

void SceneFolder::check_buffer_uri(const std::string& uri, std::uint64_t length, const std::string& place) {
  const auto holds = [&](const std::string& what, std::uint64_t size) {
    return what + " holds " + std::to_string(size) + " bytes, byteLength says " + std::to_string(length);
  };
  if (uri.starts_with("data:")) {
    if (!known_data_uri(uri)) refuse(place + ".uri", shown(uri.substr(0, 40)) + " is not a supported data URI");
    const std::uint64_t size = decoded_length(uri);
    if (size != length) refuse(place, holds("its data URI", size));
    return;
  }
  const fs::path path = checked_path(uri, place + ".uri");
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) throw io_error(path.string(), error.message());
  if (size < length) refuse(place, holds(shown(uri), size));
  if (!wanted_.emplace(path, length).second && wanted_[path] != length) {
    refuse(place, shown(uri) + " is used by two buffers of different byteLength");
  }
}

void SceneFolder::refuse(const std::string& place, const std::string& reason) const {
  throw input_error(scene_path_ + ": " + place, reason);
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
