// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace sheaf {

/// Bits from the least significant one of the first byte on. Behind the end there are zeros, and `ran_over` tells.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::uint32_t bits(unsigned count) {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < count; ++i) value |= bit() << i;
    return value;
  }
  [[nodiscard]] std::uint32_t bit() {
    const std::size_t byte = at_ / 8;
    const unsigned shift = at_ % 8;
    ++at_;
    if (byte < bytes_.size()) return bytes_[byte] >> shift & 1u;
    ran_over_ = true;
    return 0;
  }
  [[nodiscard]] bool ran_over() const { return ran_over_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ran_over_ = false;
};

}  // namespace sheaf
