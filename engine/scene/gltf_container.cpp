// SPDX-License-Identifier: MIT
#include "scene/gltf_container.hpp"

#include <algorithm>
#include <limits>

#include "core/error.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;
constexpr std::size_t header_size = 12, chunk_header_size = 8;
constexpr int max_depth = 128;  // glTF itself needs 8; `extras` may hold anything

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {  // little-endian
  return bytes[at] | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The chunk that starts at `at`: its payload. Advances `at` past it.
std::span<const std::uint8_t> take_chunk(std::span<const std::uint8_t> glb, std::size_t& at, std::uint32_t type,
                                         const char* name, const std::string& file) {
  if (glb.size() - at < chunk_header_size)
    throw input_error(file, std::string("truncated before the ") + name + " chunk");
  const std::size_t length = word(glb, at);
  if (word(glb, at + 4) != type)
    throw input_error(file, std::string("where the ") + name + " chunk should be is another");
  at += chunk_header_size;
  if (length > glb.size() - at) {
    throw input_error(
        file, std::string("the ") + name + " chunk of " + std::to_string(length) + " bytes ends after the file");
  }
  at += length;
  return glb.subspan(at - length, length);
}

void check_depth(std::string_view text, const std::string& file) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > max_depth)
        throw input_error(file, "the JSON nests deeper than " + std::to_string(max_depth) + " levels");
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

}  // namespace

GltfContainer check_container(std::span<const std::uint8_t> bytes, const std::string& file) {
  if (bytes.empty()) throw input_error(file, "is empty");
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) throw limit_error(file, "is larger than 4 GiB");
  if (bytes.size() < 4 || word(bytes, 0) != magic_gltf) return {false, text_of(bytes), {}};

  if (bytes.size() < header_size + chunk_header_size) throw input_error(file, "truncated inside the GLB header");
  if (word(bytes, 4) != 2)
    throw input_error(file, "GLB version " + std::to_string(word(bytes, 4)) + " is not supported");
  const std::size_t length = word(bytes, 8);
  if (length > bytes.size()) {
    throw input_error(file, "truncated: the header says " + std::to_string(length) + " bytes, the file has " +
                                std::to_string(bytes.size()));
  }
  if (length < header_size + chunk_header_size) throw input_error(file, "the GLB header's length is too small");

  const std::span<const std::uint8_t> glb = bytes.first(length);
  std::size_t at = header_size;
  GltfContainer container{true, text_of(take_chunk(glb, at, chunk_json, "JSON", file)), {}};
  if (at < length) container.binary = take_chunk(glb, at, chunk_bin, "BIN", file);
  return container;
}

nlohmann::json parse_json(std::string_view text, const std::string& file) {
  check_depth(text, file);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ...": the bracket is noise, the rest may quote
    // the file's own bytes.
    std::string reason = error.what();
    if (const std::size_t end = reason.find("] "); end != std::string::npos) reason = reason.substr(end + 2);
    std::replace_if(
        reason.begin(), reason.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
    throw input_error(file, "is not valid JSON: " + reason.substr(0, 200));
  }
}

}  // namespace sheaf
