// SPDX-License-Identifier: MIT
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "scene/meshopt.hpp"

namespace sheaf::meshopt {
namespace {

// Elements of `Width` numbers each, changed in place.
template <class Number, std::size_t Width, class Change>
void each(Out elements, const Change& change) {
  for (std::size_t at = 0; at < elements.size(); at += sizeof(Number) * Width) {
    Number values[Width];
    std::memcpy(values, &elements[at], sizeof(values));
    change(values);
    std::memcpy(&elements[at], values, sizeof(values));
  }
}

// To the nearest, halves away from zero. Encoders write nothing that leaves the range; it is cut off there.
template <class Number>
Number rounded(float value) {
  constexpr auto high = static_cast<float>(std::numeric_limits<Number>::max());
  constexpr float low = std::is_signed_v<Number> ? -high : 0;
  return static_cast<Number>(std::lround(std::clamp(value, low, high)));
}

template <class Number>
void octahedral(Number (&v)[4]) {
  const float one = v[2];
  if (!(one > 0)) return;
  float x = v[0] / one, y = v[1] / one;
  const float z = 1 - std::abs(x) - std::abs(y);
  const float fold = std::min(z, 0.0f);  // the lower half lies outside of the square's diagonals
  x -= std::copysign(fold, x);
  y -= std::copysign(fold, y);
  const float scale = static_cast<float>(std::numeric_limits<Number>::max()) / std::sqrt(x * x + y * y + z * z);
  v[0] = rounded<Number>(x * scale);
  v[1] = rounded<Number>(y * scale);
  v[2] = rounded<Number>(z * scale);
}

// Three components and, in the fourth, their scale and which of the four was left out: the largest, which is positive.
void quaternion(std::int16_t (&v)[4]) {
  const float scale = std::sqrt(0.5f) / static_cast<float>(v[3] | 3);
  const float x = v[0] * scale, y = v[1] * scale, z = v[2] * scale;
  const float w = std::sqrt(std::max(0.0f, 1 - x * x - y * y - z * z));
  const unsigned largest = v[3] & 3u;
  v[(largest + 1) % 4] = rounded<std::int16_t>(x * 32767);
  v[(largest + 2) % 4] = rounded<std::int16_t>(y * 32767);
  v[(largest + 3) % 4] = rounded<std::int16_t>(z * 32767);
  v[largest] = rounded<std::int16_t>(w * 32767);
}

void exponential(std::uint32_t (&v)[1]) {
  const auto both = std::bit_cast<std::int32_t>(v[0]);
  const std::int32_t mantissa = std::bit_cast<std::int32_t>(v[0] << 8) >> 8;
  v[0] = std::bit_cast<std::uint32_t>(static_cast<float>(std::ldexp(mantissa, both >> 24)));
}

// YCoCg of K bits, and alpha of one less, below a bit that says where K ends.
template <class Number>
void color(Number (&v)[4]) {
  if (v[3] == 0) return;
  using Signed = std::make_signed_t<Number>;
  const int full = (1 << std::bit_width(v[3])) - 1;
  const int luma = v[0], orange = static_cast<Signed>(v[1]), green = static_cast<Signed>(v[2]);
  const int alpha = v[3] & full >> 1;
  const float scale = static_cast<float>(std::numeric_limits<Number>::max()) / static_cast<float>(full);
  v[0] = rounded<Number>(static_cast<float>(luma + orange - green) * scale);
  v[1] = rounded<Number>(static_cast<float>(luma + green) * scale);
  v[2] = rounded<Number>(static_cast<float>(luma - orange - green) * scale);
  v[3] = rounded<Number>(static_cast<float>(alpha << 1 | (alpha & 1)) * scale);
}

}  // namespace

void apply_filter(Filter filter, std::size_t stride, Out elements) {
  const bool wide = stride == 8;
  switch (filter) {
    case Filter::none:
      return;
    case Filter::octahedral:
      return wide ? each<std::int16_t, 4>(elements, octahedral<std::int16_t>)
                  : each<std::int8_t, 4>(elements, octahedral<std::int8_t>);
    case Filter::quaternion:
      return each<std::int16_t, 4>(elements, quaternion);
    case Filter::exponential:
      return each<std::uint32_t, 1>(elements, exponential);
    case Filter::color:
      return wide ? each<std::uint16_t, 4>(elements, color<std::uint16_t>)
                  : each<std::uint8_t, 4>(elements, color<std::uint8_t>);
  }
}

}  // namespace sheaf::meshopt
