// SPDX-License-Identifier: MIT
#include "output/frame_range.hpp"

#include "output_support.hpp"

namespace sheaf {
namespace {

using Frames = std::vector<std::int64_t>;

std::string refusal(const std::string& text) {
  return test::error_of(ErrorKind::usage, [&] { (void)parse_frames(text); });
}

TEST(FrameRange, Single) {
  EXPECT_EQ(parse_frames("17"), Frames{17});
  EXPECT_EQ(parse_frames("-3"), Frames{-3});
  EXPECT_EQ(parse_frames("007"), Frames{7});
}

TEST(FrameRange, RangesHoldBothEnds) {
  EXPECT_EQ(parse_frames("1-4"), (Frames{1, 2, 3, 4}));
  EXPECT_EQ(parse_frames("5-5"), Frames{5});
  EXPECT_EQ(parse_frames("0-10:5"), (Frames{0, 5, 10}));
  EXPECT_EQ(parse_frames("0-9:4"), (Frames{0, 4, 8}));
  EXPECT_EQ(parse_frames("3-4:100"), Frames{3});
}

TEST(FrameRange, NegativeEnds) {
  EXPECT_EQ(parse_frames("-5--3"), (Frames{-5, -4, -3}));
  EXPECT_EQ(parse_frames("-1-1"), (Frames{-1, 0, 1}));
}

TEST(FrameRange, ListsKeepTheirOrderWithoutRepeats) {
  EXPECT_EQ(parse_frames("9,1,5"), (Frames{9, 1, 5}));
  EXPECT_EQ(parse_frames("3,1-5,3,5-6"), (Frames{3, 1, 2, 4, 5, 6}));
  EXPECT_EQ(parse_frames("2147483647,-2147483647"), (Frames{2147483647, -2147483647}));
}

TEST(FrameRange, RefusesWithTheItemAndTheReason) {
  EXPECT_EQ(refusal(""), "--frames \"\": an empty item; expected N, A-B or A-B:STEP, separated by commas");
  EXPECT_EQ(refusal("1,,2"), "--frames \"\": an empty item; expected N, A-B or A-B:STEP, separated by commas");
  EXPECT_EQ(refusal("1,"), "--frames \"\": an empty item; expected N, A-B or A-B:STEP, separated by commas");
  EXPECT_EQ(refusal("1,x"), "--frames \"x\": the frame is not a number");
  EXPECT_EQ(refusal("+1"), "--frames \"+1\": the frame is not a number");
  EXPECT_EQ(refusal("1.5"), "--frames \"1.5\": expected N, A-B or A-B:STEP");
  EXPECT_EQ(refusal("1:2"), "--frames \"1:2\": expected N, A-B or A-B:STEP");
  EXPECT_EQ(refusal("1-"), "--frames \"1-\": the last frame is not a number");
  EXPECT_EQ(refusal("1 - 2"), "--frames \"1 - 2\": expected N, A-B or A-B:STEP");
  EXPECT_EQ(refusal("5-1"), "--frames \"5-1\": the last frame is before the first");
  EXPECT_EQ(refusal("1-5:0"), "--frames \"1-5:0\": the step must be 1 or more");
  EXPECT_EQ(refusal("1-5:-1"), "--frames \"1-5:-1\": the step must be 1 or more");
  EXPECT_EQ(refusal("1-5:2:3"), "--frames \"1-5:2:3\": text after the step");
  EXPECT_EQ(refusal("2147483648"), "--frames \"2147483648\": the frame is beyond ±2147483647");
  EXPECT_EQ(refusal("1-99999999999999999999"),
            "--frames \"1-99999999999999999999\": the last frame is beyond ±2147483647");
}

TEST(FrameRange, IsBounded) {
  EXPECT_EQ(parse_frames("1-1000000").size(), max_frames);
  EXPECT_EQ(refusal("0-1000000"), "--frames \"0-1000000\": more than 1000000 frames in all");
  EXPECT_EQ(refusal("1-600000,1-600000"), "--frames \"1-600000\": more than 1000000 frames in all");
  EXPECT_EQ(refusal("-2147483647-2147483647"), "--frames \"-2147483647-2147483647\": more than 1000000 frames in all");
  EXPECT_EQ(parse_frames("-2147483647-2147483647:2147483647"), (Frames{-2147483647, 0, 2147483647}));
}

}  // namespace
}  // namespace sheaf
