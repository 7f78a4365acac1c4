// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sheaf {

/// RFC 3986 percent-decoding. Where an escape is malformed `whole` becomes false and the text is as it was.
[[nodiscard]] std::string percent_decoded(std::string_view uri, bool& whole);

[[nodiscard]] bool is_data_uri(std::string_view uri);

struct DataUri {
  std::vector<std::uint8_t> bytes;
  std::string fault;   // why it cannot be read; empty: it can
  std::string oddity;  // what is unusual about it though it can be read
};

/// A data URI (RFC 2397), whatever its media type and parameters say. Base64 may be of the URL alphabet, hold white
/// space or percent-escapes and lack its padding.
[[nodiscard]] DataUri read_data_uri(std::string_view uri);

}  // namespace sheaf
