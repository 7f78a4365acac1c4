// SPDX-License-Identifier: MIT
// A user's own text inside a message: short, and on one line, whatever the text is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace sheaf {

constexpr std::size_t quote_limit = 200;  // characters

namespace detail {

/// Bytes of the UTF-8 character at the front; 1 for a byte that does not begin one.
[[nodiscard]] inline std::size_t utf8_length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  std::size_t length = 1;
  if (lead >= 0xc2) length = lead >= 0xf5 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (length > text.size()) return 1;
  for (std::size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 1;
  return length;
}

}  // namespace detail

/// The text as it may stand in a message: its first 200 characters, with "…" where there were more. A control
/// character, which could end the line or drive a terminal, becomes '?'; so does a byte that is no UTF-8.
[[nodiscard]] inline std::string quote(std::string_view text) {
  std::string out;
  for (std::size_t characters = 0; !text.empty(); ++characters) {
    if (characters == quote_limit) return out + "…";
    const std::size_t length = detail::utf8_length(text);
    const auto lead = static_cast<unsigned char>(text.front());
    const bool shown = length > 1 || (lead >= 32 && lead < 127);
    out += shown ? text.substr(0, length) : std::string_view("?");
    text.remove_prefix(length);
  }
  return out;
}

}  // namespace sheaf
