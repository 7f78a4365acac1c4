// SPDX-License-Identifier: MIT
// SHA-256 (FIPS 180-4) of data that arrives in pieces: uploads on their way to disk, frames read back in blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sheaf::server {

class Sha256 {
 public:
  void update(std::string_view bytes);

  /// Ends the message: 64 lower-case hexadecimal digits. The object is spent afterwards.
  [[nodiscard]] std::string finish();

 private:
  void absorb(const std::uint8_t* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> block_{};
  std::uint64_t bytes_ = 0;
};

[[nodiscard]] std::string sha256_of(std::string_view bytes);

}  // namespace sheaf::server
