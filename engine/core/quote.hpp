// SPDX-License-Identifier: MIT
// A user's own text inside a message: short, and on one line, whatever the text is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sheaf {

constexpr std::size_t quote_limit = 200;  // characters

namespace detail {

/// Bytes of the UTF-8 character at the front; 0 where none stands there (RFC 3629: no overlong forms, no surrogates,
/// nothing above U+10FFFF).
[[nodiscard]] inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead < 0xc2 || lead > 0xf4 ? 0 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool overlong = (lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xf0 && byte(1) < 0x90);
  const bool outside = (lead == 0xed && byte(1) >= 0xa0) || (lead == 0xf4 && byte(1) >= 0x90);
  return overlong || outside ? 0 : length;
}

/// Whether the character at the front of `text`, of `length` bytes, is a control character (C0, DEL, C1).
[[nodiscard]] inline bool is_control(std::string_view text, std::size_t length) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (length == 1) return lead < 32 || lead == 127;
  return length == 2 && lead == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0;
}

}  // namespace detail

/// The text as it may stand in a message: its first `most` characters, with "…" where there were more. A control
/// character, which could end the line or drive a terminal, becomes '?'; so does a byte that is no UTF-8.
[[nodiscard]] inline std::string quote(std::string_view text, std::size_t most = quote_limit) {
  std::string out;
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == most) return out + "…";
    const std::size_t length = detail::utf8_length(text);
    const bool shown = length > 0 && !detail::is_control(text, length);
    out += shown ? text.substr(0, length) : std::string_view("?");
    text.remove_prefix(length > 0 ? length : 1);
  }
  return out;
}

/// The same in quotation marks.
[[nodiscard]] inline std::string in_quotes(std::string_view text, std::size_t most = quote_limit) {
  return "\"" + quote(text, most) + "\"";
}

/// The first twenty of `names` in quotation marks, with "…" where there were more.
template <class Names>
[[nodiscard]] std::string quoted_list(const Names& names) {
  std::string out;
  std::size_t count = 0;
  for (const auto& name : names) {
    if (count++ == 20) return out + ", …";
    out += (out.empty() ? "" : ", ") + in_quotes(name, 60);
  }
  return out;
}

/// Whole, but on one line and valid UTF-8.
[[nodiscard]] inline std::string one_line(std::string_view text) { return quote(text, std::string_view::npos); }

/// A message with its overlong words cut: what stands between spaces, slashes and colons and is longer than any file's
/// name repeats a text that nobody would read. Paths and places stay whole.
[[nodiscard]] inline std::string bounded_words(std::string_view text) {
  constexpr std::size_t longest = 600;  // bytes; NAME_MAX is 255, and a place in a file stays below that too
  std::string out;
  while (true) {
    const std::size_t end = text.find_first_of(" /:");
    const std::string_view word = text.substr(0, end);
    out += word.size() > longest ? quote(word) : std::string(word);
    if (end == std::string_view::npos) return out;
    out += text[end];
    text.remove_prefix(end + 1);
  }
}

}  // namespace sheaf
