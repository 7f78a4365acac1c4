// SPDX-License-Identifier: MIT
#include "device_data/mip_levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace sheaf {
namespace {

struct Texels {  // of one level, as numbers that may be averaged
  std::uint32_t width, height;
  std::vector<glm::vec4> values;
};

const std::array<float, 256>& decoded() {
  static const auto table = [] {
    std::array<float, 256> t{};
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table;
}

std::uint32_t encode_color(float v) {  // the nearest of the 256 by their decoded values
  const auto& table = decoded();
  const auto above = std::lower_bound(table.begin(), table.end(), v);
  if (above == table.begin()) return 0;
  if (above == table.end()) return 255;
  const auto at = static_cast<std::uint32_t>(above - table.begin());
  return v - table[at - 1] < table[at] - v ? at - 1 : at;
}

std::uint32_t encode_number(float v) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0F, 1.0F) * 255));
}

glm::vec4 decode(const std::uint8_t* rgba, MipContent content) {
  const glm::vec4 numbers(rgba[0] / 255.0F, rgba[1] / 255.0F, rgba[2] / 255.0F, rgba[3] / 255.0F);
  if (content == MipContent::data) return numbers;
  const glm::vec3 light(decoded()[rgba[0]], decoded()[rgba[1]], decoded()[rgba[2]]);
  return {content == MipContent::color_by_alpha ? light * numbers.a : light, numbers.a};
}

std::uint32_t encode(glm::vec4 v, MipContent content) {
  if (content == MipContent::color_by_alpha && v.a > 0) v = {v.r / v.a, v.g / v.a, v.b / v.a, v.a};
  const bool color = content != MipContent::data;
  std::uint32_t word = encode_number(v.a) << 24U;
  for (int c = 0; c < 3; ++c)
    word |= (color ? encode_color(v[c]) : encode_number(v[c])) << static_cast<std::uint32_t>(8 * c);
  return word;
}

// One row or column of the smaller level: which texels of the larger it covers, and how much of each.
struct Cover {
  std::uint32_t first = 0, count = 0;
  std::array<float, 3> share{};
};

Cover cover_of(std::uint32_t at, std::uint32_t from, std::uint32_t to) {
  const double begin = static_cast<double>(at) * from / to, end = static_cast<double>(at + 1) * from / to;
  Cover cover;
  cover.first = static_cast<std::uint32_t>(begin);
  for (std::uint32_t i = cover.first; i < from && i < end && cover.count < 3; ++i) {
    const double part = std::min<double>(end, i + 1) - std::max<double>(begin, i);
    cover.share[cover.count++] = static_cast<float>(part / (end - begin));
  }
  return cover;
}

Texels halved(const Texels& from) {
  Texels to{std::max(from.width / 2, 1U), std::max(from.height / 2, 1U), {}};
  to.values.resize(std::size_t{to.width} * to.height);
  for (std::uint32_t y = 0; y < to.height; ++y) {
    const Cover rows = cover_of(y, from.height, to.height);
    for (std::uint32_t x = 0; x < to.width; ++x) {
      const Cover columns = cover_of(x, from.width, to.width);
      glm::vec4 sum(0);
      for (std::uint32_t r = 0; r < rows.count; ++r)
        for (std::uint32_t c = 0; c < columns.count; ++c)
          sum += rows.share[r] * columns.share[c] *
                 from.values[std::size_t{rows.first + r} * from.width + columns.first + c];
      to.values[std::size_t{y} * to.width + x] = sum;
    }
  }
  return to;
}

}  // namespace

void append_mip_levels(const Image& image, MipContent content, std::uint32_t levels,
                       std::vector<std::uint32_t>& texels) {
  const std::size_t count = image.rgba.size() / 4, first = texels.size();
  texels.resize(first + count);
  if (count == 0) return;
  std::memcpy(&texels[first], image.rgba.data(), count * 4);
  if (levels == 1) return;
  Texels level{image.width, image.height, {}};
  level.values.reserve(count);
  for (std::size_t i = 0; i < count; ++i) level.values.push_back(decode(&image.rgba[4 * i], content));
  for (std::uint32_t k = 1; k < levels; ++k) {
    level = halved(level);
    for (const auto& value : level.values) texels.push_back(encode(value, content));
  }
}

}  // namespace sheaf
