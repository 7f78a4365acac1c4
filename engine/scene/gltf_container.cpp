// SPDX-License-Identifier: MIT
#include "scene/gltf_container.hpp"

#include <limits>
#include <utility>

#include "core/error.hpp"
#include "core/file_kind.hpp"
#include "core/quote.hpp"

namespace sheaf {
namespace {

constexpr std::uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;
constexpr std::size_t header_size = 12, chunk_header_size = 8;
constexpr int max_depth = 128;  // glTF itself needs 8; `extras` may hold anything
constexpr std::string_view how_to_convert = ": convert it, for example by \"gltf-pipeline -i OLD.glb -o NEW.glb\"";

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {  // little-endian
  return bytes[at] | std::uint32_t{bytes[at + 1]} << 8 | std::uint32_t{bytes[at + 2]} << 16 |
         std::uint32_t{bytes[at + 3]} << 24;
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct Chunk {
  std::uint32_t type = 0;
  std::span<const std::uint8_t> bytes;
};

const char* name_of(std::uint32_t type) { return type == chunk_json ? "JSON" : type == chunk_bin ? "BIN" : "unknown"; }

class GlbReader {
 public:
  GlbReader(std::span<const std::uint8_t> bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  GltfContainer read() {
    if (bytes_.size() < header_size + chunk_header_size) fail("truncated inside the GLB header");
    check_version();
    const std::size_t length = word(bytes_, 8);
    // A length that lies is no harm as long as chunks follow each other to the end of the file.
    const bool is_short = length > bytes_.size();
    const std::size_t end = is_short || length < header_size + chunk_header_size ? bytes_.size() : length;
    while (at_ < end && bytes_.size() - at_ >= chunk_header_size) keep(take_chunk());
    if (at_ < end && (is_short || !has_json_))
      fail("truncated: the header says " + std::to_string(length) + " bytes, the file has " +
           std::to_string(bytes_.size()));
    if (at_ != length)
      odd("the GLB header says " + std::to_string(length) + " bytes, its chunks end at " + std::to_string(at_));
    if (at_ == length && bytes_.size() > at_)
      odd(std::to_string(bytes_.size() - at_) + " bytes after the end that the GLB header says are ignored");
    if (!has_json_) fail("has no JSON chunk");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const { throw input_error(file_, reason); }
  void odd(const std::string& what) { out_.oddities.push_back(what); }

  void check_version() const {
    const std::uint32_t version = word(bytes_, 4);
    if (version == 1) fail("is binary glTF 1.0, only 2.0 is supported" + std::string(how_to_convert));
    if (version != 2) fail("GLB version " + std::to_string(version) + " is not supported");
  }

  Chunk take_chunk() {
    const std::size_t length = word(bytes_, at_);
    const std::uint32_t type = word(bytes_, at_ + 4);
    at_ += chunk_header_size;
    if (length > bytes_.size() - at_) {
      fail(std::string("the ") + name_of(type) + " chunk of " + std::to_string(length) + " bytes ends after the file");
    }
    at_ += length;
    const Chunk chunk{type, bytes_.subspan(at_ - length, length)};
    pass_padding();
    return chunk;
  }

  // Some writers pad a chunk without counting the padding in its length.
  void pass_padding() {
    const std::size_t next = (at_ + 3) / 4 * 4;
    const auto starts_chunk = [&](std::size_t at) {
      return at + chunk_header_size <= bytes_.size() && word(bytes_, at + 4) == chunk_bin;
    };
    if (next == at_ || starts_chunk(at_)) return;
    if (starts_chunk(next) || next == bytes_.size()) {
      odd("a chunk's padding is not part of its length");
      at_ = next;
    }
  }

  void keep(const Chunk& chunk) {
    if (chunk.type == chunk_json) {
      if (has_json_) return odd("has a second JSON chunk, which is ignored");
      has_json_ = true;
      out_.json = text_of(chunk.bytes);
      if (has_binary_) odd("the BIN chunk stands before the JSON chunk");
      if (!out_.json.ends_with('\0')) return;
      while (out_.json.ends_with('\0')) out_.json.remove_suffix(1);
      odd("the JSON chunk is padded with zeros, not with spaces");
    } else if (chunk.type == chunk_bin) {
      if (has_binary_) return odd("has a second BIN chunk, which is ignored");
      has_binary_ = true;
      out_.binary = chunk.bytes;
    }  // others are to be ignored (glTF 2.0, 4.4.3.1)
  }

  std::span<const std::uint8_t> bytes_;
  const std::string& file_;
  std::size_t at_ = header_size;
  bool has_json_ = false, has_binary_ = false;
  GltfContainer out_;
};

// JSON, or an error that says what else it is.
GltfContainer read_text(std::span<const std::uint8_t> bytes, const std::string& file) {
  GltfContainer out{text_of(bytes), {}, {}};
  if (const std::string kind = file_kind(out.json, out.json.size()); !kind.empty())
    throw input_error(file, "is not a glTF file but " + kind);
  if (out.json.starts_with("\xef\xbb\xbf")) {
    out.json.remove_prefix(3);
    out.oddities.emplace_back("the JSON begins with a byte order mark");
  }
  while (out.json.ends_with('\0')) out.json.remove_suffix(1);
  const std::size_t first = out.json.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) throw input_error(file, "is empty");
  if (out.json[first] != '{' && out.json[first] != '[') {
    const std::string_view line = out.json.substr(first, out.json.find_first_of("\r\n", first) - first);
    throw input_error(file, "is not a glTF file: it begins with " + in_quotes(line, 40));
  }
  return out;
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
  if (bytes.size() < 4 || word(bytes, 0) != magic_gltf) return read_text(bytes, file);
  return GlbReader(bytes, file).read();
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
    throw input_error(file, "is not valid JSON: " + quote(reason));
  }
}

}  // namespace sheaf
