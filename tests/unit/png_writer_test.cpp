// SPDX-License-Identifier: MIT
#include "output/png_writer.hpp"

#include <zlib.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "output_support.hpp"

namespace sheaf {
namespace {

using Bytes = std::vector<unsigned char>;

std::uint32_t big_endian(const Bytes& bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 | std::uint32_t{bytes[at + 2]} << 8 |
         bytes[at + 3];
}

// Chunks by type, their CRCs checked.
std::map<std::string, Bytes> chunks_of(const Bytes& png) {
  std::map<std::string, Bytes> chunks;
  for (std::size_t at = 8; at < png.size();) {
    const std::uint32_t size = big_endian(png, at);
    const Bytes data(png.begin() + static_cast<long>(at) + 8, png.begin() + static_cast<long>(at + 8 + size));
    EXPECT_EQ(big_endian(png, at + 8 + size), crc32(0, &png[at + 4], size + 4));
    chunks[std::string(&png[at + 4], &png[at + 8])] = data;
    at += 12 + size;
  }
  return chunks;
}

int predicted(int type, int left, int up, int corner) {
  if (type == 1) return left;
  if (type == 2) return up;
  if (type == 3) return (left + up) / 2;
  if (type == 0) return 0;
  const int guess = left + up - corner;
  int best = left;
  for (const int candidate : {up, corner})
    if (std::abs(guess - candidate) < std::abs(guess - best)) best = candidate;
  return best;
}

// A decoder for what we write: 8-bit RGB, not interlaced.
Bytes decode(const std::vector<std::byte>& file, std::uint32_t width, std::uint32_t height) {
  Bytes png(file.size());
  std::transform(file.begin(), file.end(), png.begin(), [](std::byte b) { return std::to_integer<unsigned char>(b); });
  EXPECT_EQ(Bytes(png.begin(), png.begin() + 8), (Bytes{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}));
  const auto chunks = chunks_of(png);
  const Bytes& header = chunks.at("IHDR");
  EXPECT_EQ(big_endian(header, 0), width);
  EXPECT_EQ(big_endian(header, 4), height);
  EXPECT_EQ(Bytes(header.begin() + 8, header.end()), (Bytes{8, 2, 0, 0, 0}));
  EXPECT_TRUE(chunks.contains("IEND"));
  EXPECT_TRUE(chunks.contains("sRGB"));
  const std::size_t row = std::size_t{width} * 3;
  Bytes lines(height * (row + 1));
  uLongf size = lines.size();
  EXPECT_EQ(uncompress(lines.data(), &size, chunks.at("IDAT").data(), chunks.at("IDAT").size()), Z_OK);
  EXPECT_EQ(size, lines.size());
  Bytes pixels(height * row);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t i = 0; i < row; ++i) {
      const int left = i < 3 ? 0 : pixels[y * row + i - 3], up = y == 0 ? 0 : pixels[(y - 1) * row + i];
      const int corner = i < 3 || y == 0 ? 0 : pixels[(y - 1) * row + i - 3];
      pixels[y * row + i] =
          static_cast<unsigned char>(lines[y * (row + 1) + i + 1] + predicted(lines[y * (row + 1)], left, up, corner));
    }
  return pixels;
}

Bytes one_pixel(float r, float g, float b) {
  return decode(encode_preview_png(std::vector<float>{r, g, b, 1}, 1, 1), 1, 1);
}

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

TEST(ToneMap, LowColoursKeepTheirRatios) {
  // Below the shoulder with every component at least 0.08, 0.04 is taken off and that is all.
  const glm::vec3 low = tone_map({0.5f, 0.3f, 0.1f});
  EXPECT_NEAR(low.r, 0.46f, 1e-6f);
  EXPECT_NEAR(low.g, 0.26f, 1e-6f);
  EXPECT_NEAR(low.b, 0.06f, 1e-6f);
  // Near black it fades to nothing: x - (x - 6.25 x²) = 6.25 x².
  EXPECT_NEAR(tone_map(glm::vec3(0.04f)).g, 0.01f, 1e-7f);
  EXPECT_EQ(tone_map({0.5f, 0, 0}), glm::vec3(0.5f, 0, 0));
}

TEST(ToneMap, ShoulderByHand) {
  // Grey 1.04: peak 1, 1 - 0.24² / (1 + 0.24 - 0.76) = 0.88.
  EXPECT_NEAR(tone_map(glm::vec3(1.04f)).r, 0.88f, 1e-6f);
  // Red 1 (nothing to take off): the same peak; keep = 1 / (0.15 · 0.12 + 1).
  const glm::vec3 red = tone_map({1, 0, 0});
  EXPECT_NEAR(red.r, 0.88f, 1e-6f);
  EXPECT_NEAR(red.g, 0.88f * (1 - 1 / 1.018f), 1e-6f);
}

TEST(ToneMap, RisesWithoutJumpsAndStaysBelowOne) {
  float last = 0;
  for (int i = 1; i < 20000; ++i) {
    const float value = tone_map(glm::vec3(static_cast<float>(i) * 1e-3f)).g;
    EXPECT_GE(value, last);
    EXPECT_LT(value - last, 2e-3f);
    EXPECT_LT(value, 1);
    last = value;
  }
}

TEST(Preview, KnownPixels) {
  EXPECT_EQ(one_pixel(0, 0, 0), (Bytes{0, 0, 0}));
  // 0.5 - 0.04 = 0.46 in sRGB: 1.055 · 0.46^(1/2.4) - 0.055 = 0.7084: 180.6.
  EXPECT_EQ(one_pixel(0.5f, 0.5f, 0.5f), (Bytes{181, 181, 181}));
  EXPECT_EQ(one_pixel(1e30f, 1e30f, 1e30f), (Bytes{255, 255, 255}));
}

TEST(Preview, StrangeValuesBecomeColours) {
  EXPECT_EQ(one_pixel(nan, -1, -inf), (Bytes{0, 0, 0}));
  EXPECT_EQ(one_pixel(inf, inf, inf), (Bytes{255, 255, 255}));
  EXPECT_EQ(one_pixel(inf, nan, 0)[0], 255);
}

TEST(Preview, PremultipliedIsOverBlackWhateverAlpha) {
  const std::vector<float> clear{0.5f, 0.5f, 0.5f, 0.1f};
  EXPECT_EQ(decode(encode_preview_png(clear, 1, 1), 1, 1), one_pixel(0.5f, 0.5f, 0.5f));
}

TEST(Preview, EveryFilterDecodes) {
  // Gradients, flat parts and noise, so that each filter wins somewhere.
  const std::uint32_t width = 67, height = 41;
  std::mt19937 random(7);
  std::vector<float> rgba;
  Bytes expected;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const float noise = y > 30 ? static_cast<float>(random() % 256) / 255 : 0;
      const glm::vec3 color{static_cast<float>(x * y % 91) / 91, static_cast<float>(x) / 67 + noise,
                            y < 10 ? 0.3f : static_cast<float>(y) / 41};
      rgba.insert(rgba.end(), {color.r, color.g, color.b, 1});
      const Bytes pixel = one_pixel(color.r, color.g, color.b);
      expected.insert(expected.end(), pixel.begin(), pixel.end());
    }
  EXPECT_EQ(decode(encode_preview_png(rgba, width, height), width, height), expected);
}

TEST(Preview, SizeMustFit) {
  EXPECT_EQ(test::error_of(ErrorKind::usage, [] { (void)encode_preview_png(std::vector<float>(12), 2, 2); }),
            "preview: 12 values are not a picture of 2x2");
  EXPECT_THROW((void)encode_preview_png({}, 0, 0), Error);
}

class PreviewFileTest : public test::OutputTest {};

TEST_F(PreviewFileTest, IsWrittenWhole) {
  const std::vector<float> rgba{0.5f, 0.25f, 0.125f, 1};
  write_preview(path("a.png"), rgba, 1, 1);
  const std::vector<std::byte> png = encode_preview_png(rgba, 1, 1);
  EXPECT_EQ(test::contents(path("a.png")), std::string(reinterpret_cast<const char*>(png.data()), png.size()));
  EXPECT_EQ(names(), std::vector<std::string>{"a.png"});
}

}  // namespace
}  // namespace sheaf
