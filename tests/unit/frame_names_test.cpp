// SPDX-License-Identifier: MIT
#include "output/frame_names.hpp"

#include <array>
#include <cstdio>

#include "output_support.hpp"

namespace sheaf {
namespace {

std::string refusal(const std::string& pattern) {
  return test::error_of(ErrorKind::usage, [&] { FrameNames{pattern}; });
}

TEST(FrameNames, PadsToTheRun) {
  const FrameNames names("name.####.exr");
  EXPECT_EQ(names.frame(12), "name.0012.exr");
  EXPECT_EQ(names.frame(0), "name.0000.exr");
  EXPECT_EQ(names.preview(12), "name.0012.png");
  EXPECT_EQ(FrameNames("#.exr").frame(7), "7.exr");
  EXPECT_EQ(FrameNames("a######b.exr").frame(42), "a000042b.exr");
  EXPECT_EQ(FrameNames("a######b.exr").preview(42), "a000042b.png");
}

TEST(FrameNames, WritesLongerNumbersWhole) {
  EXPECT_EQ(FrameNames("f##.exr").frame(12345), "f12345.exr");
  EXPECT_EQ(FrameNames("f##.exr").frame(-12345), "f-12345.exr");
}

TEST(FrameNames, PadsNegativesAsPrintf) {
  for (const std::int64_t number : {-1, -12, -123, -1234, -12345, 0, 7}) {
    std::array<char, 32> expected{};
    std::snprintf(expected.data(), expected.size(), "f.%04lld.exr", static_cast<long long>(number));
    EXPECT_EQ(FrameNames("f.####.exr").frame(number), expected.data());
  }
  EXPECT_EQ(FrameNames("f.####.exr").frame(-2), "f.-002.exr");
  EXPECT_EQ(FrameNames("f.##.exr").preview(-2), "f.-2.png");
  EXPECT_EQ(FrameNames("f#.exr").preview(-1), "f-1.png");
}

TEST(FrameNames, RefusesWithTheReason) {
  EXPECT_EQ(refusal("name.exr"), "--name \"name.exr\": has no run of '#' for the frame number");
  EXPECT_EQ(refusal("a##b#.exr"), "--name \"a##b#.exr\": has more than one run of '#'");
  EXPECT_EQ(refusal("d/a#.exr"), "--name \"d/a#.exr\": a frame's name cannot hold '/'; the folder is --out");
  EXPECT_EQ(refusal("a#.png"), "--name \"a#.png\": does not end in .exr");
  EXPECT_EQ(refusal("a.exr#"), "--name \"a.exr#\": does not end in .exr");
  EXPECT_EQ(refusal(""), "--name \"\": does not end in .exr");
  EXPECT_EQ(refusal(".exr"), "--name \".exr\": has no run of '#' for the frame number");
  EXPECT_EQ(refusal("a\n#.exr"), "--name: the pattern has a control character in it");
  EXPECT_NE(refusal(std::string(300, 'a') + "#.exr").find("longer than 200 bytes"), std::string::npos);
}

TEST(FrameNames, DefaultIsTheScenesStem) {
  EXPECT_EQ(default_name_pattern("scenes/whitted.glb"), "whitted.####.exr");
  EXPECT_EQ(default_name_pattern("a.b.gltf"), "a.b.####.exr");
  EXPECT_EQ(default_name_pattern("take#2.glb"), "take_2.####.exr");
  EXPECT_EQ(default_name_pattern("a\tb.glb"), "a_b.####.exr");
  EXPECT_EQ(default_name_pattern(""), "frame.####.exr");
}

TEST(FrameNames, DefaultIsAlwaysAllowed) {
  std::string umlauts = "x";
  for (int i = 0; i < 150; ++i) umlauts += "\xc3\xa4";
  const std::string pattern = default_name_pattern(umlauts + ".glb");
  EXPECT_NO_THROW(FrameNames{pattern});
  EXPECT_NE(static_cast<unsigned char>(pattern[pattern.size() - 10]), 0xc3) << "cut inside a character";
}

}  // namespace
}  // namespace sheaf
