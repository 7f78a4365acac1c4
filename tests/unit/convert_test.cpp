// SPDX-License-Identifier: MIT
// Whole numbers by floats, as shaders work with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>

#include "bounds_shaders.hpp"

namespace sheaf::test {
namespace {

void expect_divided(std::uint64_t n, std::uint64_t d) {
  const auto got = shader::divided(static_cast<unsigned>(n), static_cast<unsigned>(d));
  ASSERT_EQ(got.x, n / d) << n << " / " << d;
  ASSERT_EQ(got.y, n % d) << n << " % " << d;
}

/// On both sides of every multiple, quotients below 2^21 and numbers below 2^31.
TEST(Convert, DividesLikeIntegers) {
  for (std::uint64_t d : {1U, 2U, 3U, 5U, 7U, 8U, 64U, 1000U, 2560U, 10240U, 61440U, 65535U, 1000003U, (1U << 23) + 1U,
                          (1U << 24) - 1U}) {
    const std::uint64_t most = std::min<std::uint64_t>((1U << 21) - 1U, ((1ULL << 31U) - 1) / d - 1);
    const std::uint64_t step = std::max<std::uint64_t>(most / 5000, 1);
    for (std::uint64_t quotient = 1; quotient <= most; quotient += step)
      for (const std::uint64_t n : {quotient * d - 1, quotient * d, quotient * d + 1}) expect_divided(n, d);
    for (const std::uint64_t n : {most * d, most * d + d - 1}) expect_divided(n, d);
  }
}

TEST(Convert, FindsTheLowestBit) {
  for (unsigned bit = 0; bit < 32; ++bit)
    for (const std::uint32_t above : {0U, 0x5A5A5A5AU, 0xFFFFFFFFU}) {
      const std::uint32_t v = 1U << bit | (bit < 31 ? above << (bit + 1) : 0U);
      EXPECT_EQ(shader::lowest_bit(v), static_cast<unsigned>(std::countr_zero(v))) << v;
    }
}

}  // namespace
}  // namespace sheaf::test
