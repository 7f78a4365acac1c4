// SPDX-License-Identifier: MIT
#include "output/png_writer.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>

#include "core/error.hpp"
#include "output/atomic_file.hpp"

namespace {

// stb_image_write writes filters and chunks, and takes libdeflate for the stream; level 1 is its fastest. libspng
// compresses with zlib: at its level 1 and the same filter it takes 1.7 times the time and 1.09 times the bytes
// (1280x720).
constexpr int deflate_level = 1;
constexpr int paeth_filter = 4;  // for all lines; to try all five takes half as long again and saves nothing

unsigned char* deflated(unsigned char* bytes, int count, int* size, int) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(deflate_level), &libdeflate_free_compressor);
  if (!compressor) return nullptr;
  const auto given = static_cast<std::size_t>(count);
  const std::size_t most = libdeflate_zlib_compress_bound(compressor.get(), given);
  auto* result = static_cast<unsigned char*>(std::malloc(most));  // which stb_image_write frees
  if (result != nullptr)
    *size = static_cast<int>(libdeflate_zlib_compress(compressor.get(), bytes, given, result, most));
  return result;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS deflated
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace sheaf {
namespace {

constexpr std::size_t channels = 3;
constexpr std::uint32_t max_side = 1u << 20;

// 0 for NaN and negatives; the clamp keeps infinities out of the curve's quotients.
float displayable(float value) { return value > 0 ? std::min(value, 65504.0f) : 0.0f; }

// IEC 61966-2-1, rounded to 8 bits: a table brings within reach of the code, and the value where each code begins
// decides.
class Srgb8 {
 public:
  Srgb8() {
    for (std::size_t code = 0; code < begins_.size(); ++code) {
      const double encoded = (static_cast<double>(code) - 0.5) / 255;
      begins_[code] =
          static_cast<float>(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
    }
    std::size_t code = 0;
    for (std::size_t step = 0; step < nearby_.size(); ++step) {
      while (code < 255 && begins_[code + 1] <= static_cast<float>(step) / steps) ++code;
      nearby_[step] = static_cast<unsigned char>(code);
    }
  }

  [[nodiscard]] unsigned char operator()(float linear) const {
    const float value = std::clamp(linear, 0.0f, 1.0f);
    std::size_t code = nearby_[static_cast<std::size_t>(value * steps)];
    while (code < 255 && value >= begins_[code + 1]) ++code;
    return static_cast<unsigned char>(code);
  }

 private:
  static constexpr float steps = 4096;
  std::array<float, 256> begins_{};
  std::array<unsigned char, 4097> nearby_{};
};

std::vector<unsigned char> displayed(std::span<const float> rgba) {
  static const Srgb8 srgb8;
  std::vector<unsigned char> image(rgba.size() / 4 * channels);
  for (std::size_t pixel = 0; pixel < rgba.size() / 4; ++pixel) {
    const glm::vec3 display = tone_map({rgba[pixel * 4], rgba[pixel * 4 + 1], rgba[pixel * 4 + 2]});
    for (int c = 0; c < 3; ++c) image[pixel * channels + static_cast<std::size_t>(c)] = srgb8(display[c]);
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
  if ((std::size_t{width} * channels + 1) * height > INT_MAX)
    throw Error(ErrorKind::limit, "preview: a PNG here holds at most 2 GiB");
  const std::vector<unsigned char> image = displayed(rgba);
  stbi_write_force_png_filter = paeth_filter;
  int size = 0;
  const std::unique_ptr<unsigned char, decltype(&std::free)> file(
      stbi_write_png_to_mem(image.data(), static_cast<int>(width * channels), static_cast<int>(width),
                            static_cast<int>(height), static_cast<int>(channels), &size),
      &std::free);
  if (!file) throw std::bad_alloc();

  // The chunk sRGB with perceptual intent, which stb_image_write does not have: after signature and IHDR.
  constexpr std::array<unsigned char, 13> srgb{0, 0, 0, 1, 's', 'R', 'G', 'B', 0, 0xae, 0xce, 0x1c, 0xe9};
  constexpr std::size_t header = 8 + 25;
  const std::span written(file.get(), static_cast<std::size_t>(size));
  std::vector<std::byte> png(written.size() + srgb.size());
  auto at = std::ranges::copy(std::as_bytes(written.first(header)), png.begin()).out;
  at = std::ranges::copy(std::as_bytes(std::span(srgb)), at).out;
  std::ranges::copy(std::as_bytes(written.subspan(header)), at);
  return png;
}

void write_preview(const std::string& path, std::span<const float> rgba, std::uint32_t width, std::uint32_t height) {
  write_file_atomically(path, encode_preview_png(rgba, width, height));
}

}  // namespace sheaf
