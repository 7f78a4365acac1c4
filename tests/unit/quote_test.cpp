// SPDX-License-Identifier: MIT
// What of a user's text a message repeats.
#include "core/quote.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/error.hpp"

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
  EXPECT_EQ(quote("\xe0\x80\xaf"), "???");
  EXPECT_EQ(quote("\xed\xa0\x80"), "???");       // a surrogate
  EXPECT_EQ(quote("\xf4\x90\x80\x80"), "????");  // above U+10FFFF
  EXPECT_EQ(quote("\xc2\x9b"
                  "1m"),
            "?1m");  // U+009B, which a terminal takes for an escape
}

TEST(Quote, ListsTwentyNames) {
  const std::vector<std::string> few = {"a", "b"}, many(21, "n");
  EXPECT_EQ(quoted_list(few), R"("a", "b")");
  EXPECT_EQ(quoted_list(many), R"("n")" + repeated(19, R"(, "n")") + ", …");
}

TEST(Quote, ErrorsAreOneLineAndKeepPaths) {
  const std::string path = "/a/" + repeated(255, "d") + "/" + repeated(255, "e") + "/f.glb";
  EXPECT_EQ(std::string(input_error(path + ": nodes[3]", "x").what()), path + ": nodes[3]: x");
  EXPECT_EQ(std::string(input_error("a\nb", "c\xff").what()), "a?b: c?");
  EXPECT_EQ(std::string(io_error("/a/" + repeated(5000, "x"), "y").what()), "/a/" + repeated(200, "x") + "…: y");
}

}  // namespace
}  // namespace sheaf
