// SPDX-License-Identifier: MIT
#include "util/ids.hpp"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "core/error.hpp"

namespace sheaf::server {

std::string random_id() {
  std::array<std::uint8_t, 16> bytes{};
  ssize_t got = 0;
  do {
    got = ::getrandom(bytes.data(), bytes.size(), 0);
  } while (got < 0 && errno == EINTR);
  if (got != static_cast<ssize_t>(bytes.size())) throw io_error("getrandom", std::strerror(errno));

  std::string id;
  std::uint32_t pool = 0;
  int bits = 0;
  for (const std::uint8_t byte : bytes) {
    pool = (pool << 8 | byte) & 0xffff;
    for (bits += 8; bits >= 5; bits -= 5) id += "abcdefghijklmnopqrstuvwxyz234567"[pool >> (bits - 5) & 31];
  }
  id += "abcdefghijklmnopqrstuvwxyz234567"[pool << (5 - bits) & 31];  // 128 = 25 × 5 + 3
  return id;
}

bool is_id(std::string_view text) {
  return text.size() == 26 &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '2' && c <= '7'); });
}

}  // namespace sheaf::server
