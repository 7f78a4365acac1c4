// SPDX-License-Identifier: MIT
// Four floats that GCC and Clang keep in one register, on any CPU.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "hierarchy/object_hierarchy.hpp"

namespace sheaf::simd {

using Vec4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Vec4 splat(float x) { return Vec4{x, x, x, x}; }
// One instruction each on x86, where compilers do not reliably find it; the same result as `a < b ? a : b`, also for
// NaN.
#if defined(__SSE__)
inline Vec4 min(Vec4 a, Vec4 b) { return _mm_min_ps(a, b); }
inline Vec4 max(Vec4 a, Vec4 b) { return _mm_max_ps(a, b); }
#else
inline Vec4 min(Vec4 a, Vec4 b) { return a < b ? a : b; }
inline Vec4 max(Vec4 a, Vec4 b) { return a > b ? a : b; }
#endif

struct Bounds {  // x y z; the fourth lane is anything. Not initialised by itself: tables of it are filled as needed
  Vec4 lo, hi;

  static Bounds nothing() {
    return {splat(std::numeric_limits<float>::infinity()), splat(-std::numeric_limits<float>::infinity())};
  }
  void add(Vec4 point) {
    lo = min(lo, point);
    hi = max(hi, point);
  }
  void add(const Bounds& other) {
    lo = min(lo, other.lo);
    hi = max(hi, other.hi);
  }
  /// Half the surface; 0 for a box that holds nothing.
  [[nodiscard]] float half_area() const {
    const Vec4 d = hi - lo;
    return d[0] >= 0 ? d[0] * d[1] + d[1] * d[2] + d[2] * d[0] : 0.0f;
  }
  [[nodiscard]] Box box() const { return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}; }
};

/// A primitive's box with its number in the lower corner's fourth lane. The number's bits are lifted into the range of
/// normal floats, so that arithmetic on all four lanes never meets a denormal (a hundred times slower) nor a NaN.
struct Primitive {
  Bounds bounds;

  static constexpr std::uint32_t lift = 0x20000000u;  // 2^-63 up to 2^-47 for the 2^27 numbers
  static Primitive of(const Box& box, std::uint32_t number) {
    const auto lane = std::bit_cast<float>(lift + number);
    return {{Vec4{box.lo.x, box.lo.y, box.lo.z, lane}, Vec4{box.hi.x, box.hi.y, box.hi.z, 0}}};
  }
  [[nodiscard]] std::uint32_t number() const { return std::bit_cast<std::uint32_t>(float{bounds.lo[3]}) - lift; }

  /// The box's middle, held within a quarter of the float range so that differences of middles stay finite; a box
  /// from -inf to inf, whose middle is NaN, goes to the low end.
  [[nodiscard]] Vec4 middle() const {
    const Vec4 reach = splat(std::numeric_limits<float>::max() / 4);
    const Vec4 m = bounds.lo * 0.5f + bounds.hi * 0.5f;
    return min(max(m, -reach), reach);
  }
};

}  // namespace sheaf::simd
