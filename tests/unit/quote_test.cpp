// SPDX-License-Identifier: MIT
// What of a user's text a message repeats.
#include "core/quote.hpp"

#include <gtest/gtest.h>

namespace sheaf {
namespace {

std::string repeated(std::size_t times, const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < times; ++i) out += text;
  return out;
}

TEST(Quote, LeavesShortTextAlone) {
  EXPECT_EQ(quote(""), "");
  EXPECT_EQ(quote("wood grain.png"), "wood grain.png");
  EXPECT_EQ(quote("na\xc3\xafve \xe6\x9c\xa8 \xf0\x9f\x8c\xb2"), "na\xc3\xafve \xe6\x9c\xa8 \xf0\x9f\x8c\xb2");
}

TEST(Quote, CutsAfterTwoHundredCharacters) {
  for (const std::string character : {"x", "\xc3\xaf", "\xe6\x9c\xa8", "\xf0\x9f\x8c\xb2"}) {
    EXPECT_EQ(quote(repeated(200, character)), repeated(200, character));
    EXPECT_EQ(quote(repeated(201, character)), repeated(200, character) + "…");
    EXPECT_EQ(quote(repeated(100'000, character)), repeated(200, character) + "…");
  }
}

TEST(Quote, KeepsToOneLineOfText) {
  EXPECT_EQ(quote("a\nb\r\tc\x1b[1m\x7f"), "a?b??c?[1m?");
  EXPECT_EQ(quote(std::string("a\0b", 3)), "a?b");
}

TEST(Quote, CountsBytesThatAreNoText) {
  EXPECT_EQ(quote("\xff\xc3 \xe6\x9c"), "?? ??");
  EXPECT_EQ(quote(repeated(100'000, "\x80")), repeated(200, "?") + "…");
  EXPECT_EQ(quote("\xc0\xaf"), "??");  // an overlong '/'
}

}  // namespace
}  // namespace sheaf
