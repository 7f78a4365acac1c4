// SPDX-License-Identifier: MIT
#include "scene/data_uri.hpp"

#include <algorithm>
#include <array>

#include "core/quote.hpp"

namespace sheaf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return out;
}

constexpr std::uint8_t no_digit = 64, white = 65, padding = 66;

constexpr std::array<std::uint8_t, 256> make_digits() {
  std::array<std::uint8_t, 256> table{};
  table.fill(no_digit);
  for (std::uint8_t i = 0; i < 26; ++i) {
    table[static_cast<std::size_t>('A') + i] = i;
    table[static_cast<std::size_t>('a') + i] = static_cast<std::uint8_t>(26 + i);
  }
  for (std::uint8_t i = 0; i < 10; ++i) table[static_cast<std::size_t>('0') + i] = static_cast<std::uint8_t>(52 + i);
  table['+'] = table['-'] = 62;
  table['/'] = table['_'] = 63;
  for (const char c : {' ', '\t', '\r', '\n', '\f'}) table[static_cast<std::size_t>(c)] = white;
  table['='] = padding;
  return table;
}

constexpr std::array<std::uint8_t, 256> digits = make_digits();

// Appends what `text` stands for; false where it is no base64.
bool decode_base64(std::string_view text, DataUri& out) {
  out.bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t word = 0;
  std::size_t count = 0, pads = 0;
  bool odd = false;
  for (const char c : text) {
    const std::uint8_t digit = digits[static_cast<unsigned char>(c)];
    odd = odd || digit == white || c == '-' || c == '_';
    if (digit == white) continue;
    if (digit == padding) {
      ++pads;
      continue;
    }
    if (digit == no_digit || pads > 0) return false;
    word = word << 6 | digit;
    if (++count % 4 != 0) continue;
    for (const int shift : {16, 8, 0}) out.bytes.push_back(static_cast<std::uint8_t>(word >> shift));
    word = 0;
  }
  const std::size_t left = count % 4;
  if (left == 1) return false;
  if (left >= 2) out.bytes.push_back(static_cast<std::uint8_t>(word >> (left == 2 ? 4 : 10)));
  if (left == 3) out.bytes.push_back(static_cast<std::uint8_t>(word >> 2));
  if (odd || pads != (4 - left) % 4) out.oddity = "its base64 is not in the usual form";
  return true;
}

bool is_usual(std::string_view type) {
  for (const std::string_view known : {"application/octet-stream", "application/gltf-buffer", "image/png", "image/jpeg",
                                       "image/webp", "image/ktx2", "image/gif", "image/bmp", "text/plain"})
    if (type == known) return true;
  return false;
}

}  // namespace

std::string percent_decoded(std::string_view uri, bool& whole) {
  whole = true;
  std::string out;
  out.reserve(uri.size());
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      out += uri[i];
      continue;
    }
    if (i + 2 >= uri.size() || hex_digit(uri[i + 1]) < 0 || hex_digit(uri[i + 2]) < 0) {
      whole = false;
      return std::string(uri);
    }
    out += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
    i += 2;
  }
  return out;
}

bool is_data_uri(std::string_view uri) { return lower(uri.substr(0, 5)) == "data:"; }

DataUri read_data_uri(std::string_view uri) {
  DataUri out;
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos) {
    out.fault = in_quotes(uri, 40) + " is a data URI without a comma, and so without data";
    return out;
  }
  const std::string_view head = uri.substr(5, comma - 5);
  std::string_view type = head.substr(0, head.find(';'));
  bool base64 = false;
  for (std::size_t at = head.find(';'); at != std::string_view::npos; at = head.find(';', at + 1)) {
    std::string name = lower(head.substr(at + 1, head.find(';', at + 1) - at - 1));
    std::erase(name, ' ');
    base64 = base64 || name == "base64";
  }
  std::string decoded;
  std::string_view data = uri.substr(comma + 1);
  bool whole = true;
  if (data.find('%') != std::string_view::npos) data = decoded = percent_decoded(data, whole);
  if (!base64) {
    out.bytes.assign(data.begin(), data.end());
    out.oddity = "is a data URI that is not base64";
  } else if (!whole || !decode_base64(data, out)) {
    out.bytes.clear();
    out.fault = in_quotes(uri, 40) + " does not hold valid base64";
    return out;
  }
  if (!is_usual(type)) {
    out.oddity = "has the media type " + in_quotes(type, 60) + ", which is none of glTF's: the bytes decide";
  } else if (head.size() != type.size() + std::string_view(";base64").size() && base64) {
    out.oddity = "has parameters in its media type: " + in_quotes(head, 80);
  }
  return out;
}

}  // namespace sheaf
