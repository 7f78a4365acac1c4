// SPDX-License-Identifier: MIT
#include "device_data/mip_levels.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sheaf {
namespace {

Image image(std::uint32_t width, std::uint32_t height, const std::vector<std::uint32_t>& words) {
  Image i{"test", width, height, {}};
  for (const auto word : words)
    for (std::uint32_t c = 0; c < 4; ++c) i.rgba.push_back(static_cast<std::uint8_t>(word >> (8 * c)));
  return i;
}

std::vector<std::uint32_t> levels_of(const Image& i, MipContent content, std::uint32_t levels) {
  std::vector<std::uint32_t> texels{42};  // something before it
  append_mip_levels(i, content, levels, texels);
  EXPECT_EQ(texels.front(), 42U);
  return {texels.begin() + 1, texels.end()};
}

TEST(MipLevels, LevelZeroIsTheImage) {
  const std::vector<std::uint32_t> words{0xFF112233, 0x80445566, 0x00778899, 0xFFAABBCC};
  EXPECT_EQ(levels_of(image(2, 2, words), MipContent::color, 1), words);
  const auto two = levels_of(image(2, 2, words), MipContent::color, 2);
  ASSERT_EQ(two.size(), 5U);
  EXPECT_TRUE(std::equal(words.begin(), words.end(), two.begin()));
}

TEST(MipLevels, NumbersAreAveragedAsTheyAre) {
  const auto l = levels_of(image(2, 1, {0xFF000000, 0xFF0000C8}), MipContent::data, 2);
  EXPECT_EQ(l.back(), 0xFF000064U);
}

// Half black, half white is light of 0.5: sRGB 188, not 128.
TEST(MipLevels, ColoursAreAveragedAsLight) {
  const auto l = levels_of(image(2, 1, {0xFF000000, 0xFFFFFFFF}), MipContent::color, 2);
  EXPECT_EQ(l.back(), 0xFFBCBCBCU);
}

// What is cut out gives no colour to what is there.
TEST(MipLevels, ColoursByAlphaIgnoreWhatIsCutOut) {
  const auto l = levels_of(image(2, 1, {0x00FFFFFF, 0xFF0000FF}), MipContent::color_by_alpha, 2);
  EXPECT_EQ(l.back(), 0x800000FFU);
}

// Sizes that are no powers of two: the mean of the whole image survives every level, as far as 8 bits tell it.
TEST(MipLevels, OddSizesKeepTheMean) {
  for (const auto& [width, height] : {std::pair{5U, 3U}, {7U, 1U}, {13U, 11U}, {1U, 6U}}) {
    std::vector<std::uint32_t> words;
    double sum = 0;
    for (std::uint32_t i = 0; i < width * height; ++i) {
      words.push_back(0xFF000000U | (i * 97 % 251));
      sum += i * 97 % 251;
    }
    std::uint32_t levels = 1;
    for (std::uint32_t side = std::max(width, height); side > 1; side /= 2) ++levels;
    const auto l = levels_of(image(width, height, words), MipContent::data, levels);
    EXPECT_NEAR(l.back() & 0xFFU, sum / (width * height), 0.51) << width << "x" << height;
  }
}

}  // namespace
}  // namespace sheaf
