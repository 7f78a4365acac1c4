// SPDX-License-Identifier: MIT
#include "output/png_writer.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "core/error.hpp"
#include "output/atomic_file.hpp"

namespace sheaf {
namespace {

constexpr std::size_t channels = 3;
constexpr std::uint32_t max_side = 1u << 20;
constexpr int zlib_level = 6;

// 0 for NaN and negatives; the clamp keeps infinities out of the curve's quotients.
float displayable(float value) { return value > 0 ? std::min(value, 65504.0f) : 0.0f; }

std::byte to_srgb8(float linear) {  // IEC 61966-2-1
  const float encoded = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<std::byte>(std::lround(std::clamp(encoded, 0.0f, 1.0f) * 255));
}

using Row = std::vector<std::byte>;

int paeth(int left, int up, int corner) {
  const int guess = left + up - corner;
  const int to_left = std::abs(guess - left), to_up = std::abs(guess - up), to_corner = std::abs(guess - corner);
  if (to_left <= to_up && to_left <= to_corner) return left;
  return to_up <= to_corner ? up : corner;
}

// PNG 1.2, section 6: filter types None, Sub, Up, Average, Paeth.
Row filtered(const Row& row, const Row& above, int type) {
  Row result(row.size() + 1);
  result[0] = static_cast<std::byte>(type);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int left = i < channels ? 0 : static_cast<int>(row[i - channels]);
    const int corner = i < channels ? 0 : static_cast<int>(above[i - channels]);
    const int up = static_cast<int>(above[i]);
    const std::array guesses{0, left, up, (left + up) / 2, paeth(left, up, corner)};
    result[i + 1] = static_cast<std::byte>(static_cast<int>(row[i]) - guesses[static_cast<std::size_t>(type)]);
  }
  return result;
}

// The usual heuristic of section 9.6: the least sum of differences taken as signed.
Row best_filtered(const Row& row, const Row& above) {
  Row best;
  long best_cost = 0;
  for (int type = 0; type < 5; ++type) {
    Row candidate = filtered(row, above, type);
    long cost = 0;
    for (std::size_t i = 1; i < candidate.size(); ++i) cost += std::abs(static_cast<signed char>(candidate[i]));
    if (best.empty() || cost < best_cost) {
      best = std::move(candidate);
      best_cost = cost;
    }
  }
  return best;
}

void append_u32(std::vector<std::byte>& to, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<std::byte>(value >> shift & 0xff));
}

void append_chunk(std::vector<std::byte>& png, std::string_view type, std::span<const std::byte> data) {
  append_u32(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = png.size();
  for (const char c : type) png.push_back(static_cast<std::byte>(c));
  png.insert(png.end(), data.begin(), data.end());
  const uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(png.data() + start), png.size() - start);
  append_u32(png, static_cast<std::uint32_t>(crc));
}

std::vector<std::byte> deflated(std::span<const std::byte> data) {
  uLongf size = compressBound(data.size());
  std::vector<std::byte> result(size);
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(data.data()),
                data.size(), zlib_level) != Z_OK)
    throw Error(ErrorKind::io, "zlib: compressing a preview failed");
  result.resize(size);
  return result;
}

std::vector<std::byte> filtered_image(std::span<const float> rgba, std::uint32_t width, std::uint32_t height) {
  std::vector<std::byte> image;
  image.reserve(height * (width * channels + 1));
  Row row(width * channels), above(row.size());
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const float* pixel = &rgba[(y * width + x) * 4];
      const glm::vec3 display = tone_map({pixel[0], pixel[1], pixel[2]});
      for (int c = 0; c < 3; ++c) row[x * channels + static_cast<std::size_t>(c)] = to_srgb8(display[c]);
    }
    const Row best = best_filtered(row, above);
    image.insert(image.end(), best.begin(), best.end());
    std::swap(row, above);
  }
  return image;
}

}  // namespace

// Khronos PBR Neutral: F90 of 0.04 is taken off so that albedo comes out as itself, the peak above 0.76 is compressed
// by a hyperbola to below 1, and what was compressed is desaturated.
glm::vec3 tone_map(glm::vec3 linear) {
  constexpr float fresnel = 0.04f, start = 0.8f - fresnel, desaturation = 0.15f;
  glm::vec3 color{displayable(linear.r), displayable(linear.g), displayable(linear.b)};
  const float least = std::min({color.r, color.g, color.b});
  color -= least < 2 * fresnel ? least - least * least / (4 * fresnel) : fresnel;
  const float peak = std::max({color.r, color.g, color.b});
  if (peak < start) return color;
  const float room = 1 - start;
  const float new_peak = 1 - room * room / (peak + room - start);
  const float keep = 1 / (desaturation * (peak - new_peak) + 1);
  return glm::mix(glm::vec3(new_peak), color * (new_peak / peak), keep);
}

std::vector<std::byte> encode_preview_png(std::span<const float> rgba, std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > max_side || height > max_side ||
      rgba.size() != std::size_t{4} * width * height)
    throw Error(ErrorKind::usage, "preview: " + std::to_string(rgba.size()) + " values are not a picture of " +
                                      std::to_string(width) + "x" + std::to_string(height));
  const std::vector<std::byte> pixels = deflated(filtered_image(rgba, width, height));
  if (pixels.size() > 0x7fffffff) throw Error(ErrorKind::limit, "preview: a PNG chunk holds at most 2 GiB");

  std::vector<std::byte> png;
  for (const unsigned char c : {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a}) png.push_back(std::byte{c});
  std::vector<std::byte> header;
  append_u32(header, width);
  append_u32(header, height);
  for (const unsigned char c : {8, 2, 0, 0, 0}) header.push_back(std::byte{c});  // 8 bits, RGB, not interlaced
  append_chunk(png, "IHDR", header);
  append_chunk(png, "sRGB", std::array{std::byte{0}});  // perceptual intent
  append_chunk(png, "IDAT", pixels);
  append_chunk(png, "IEND", {});
  return png;
}

void write_preview(const std::string& path, std::span<const float> rgba, std::uint32_t width, std::uint32_t height) {
  write_file_atomically(path, encode_preview_png(rgba, width, height));
}

}  // namespace sheaf
