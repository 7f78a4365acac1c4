// SPDX-License-Identifier: MIT
// The cheapest plane to cut a range at: between bins into which the primitives' middles are dropped, or, for a few
// primitives, between any two of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "hierarchy/simd.hpp"

namespace sheaf {

inline constexpr std::uint32_t max_bins = 32;
// Smaller ranges get 16 bins: sweeping over 32 would cost more than filling them.
inline constexpr std::uint32_t many_bins_from = 4096;

struct Range {
  std::uint32_t first = 0, count = 0;
  simd::Bounds bounds = simd::Bounds::nothing(), middles = simd::Bounds::nothing();
};

struct Bins {
  std::array<std::array<simd::Bounds, max_bins>, 3> bounds;
  std::array<std::array<std::uint32_t, max_bins>, 3> count;

  explicit Bins(std::uint32_t used) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t b = 0; b < used; ++b) {
        bounds[axis][b] = simd::Bounds::nothing();
        count[axis][b] = 0;
      }
    }
  }
  void add(const Bins& other, std::uint32_t used) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::uint32_t b = 0; b < used; ++b) {
        bounds[axis][b].add(other.bounds[axis][b]);
        count[axis][b] += other.count[axis][b];
      }
    }
  }
};

/// Maps a middle to its bin along each axis; an axis along which all middles agree has scale 0.
struct Binning {
  std::uint32_t bins;
  simd::Vec4 origin, scale;

  explicit Binning(const Range& range)
      : bins(range.count >= many_bins_from ? 32 : 16), origin(range.middles.lo), scale{} {
    const simd::Vec4 extent = range.middles.hi - range.middles.lo;
    for (int axis = 0; axis < 3; ++axis) {
      // Smaller extents would give an infinite scale, and 0 * inf.
      if (extent[axis] > 1e-36f) scale[axis] = static_cast<float>(bins) / extent[axis];
    }
  }
  [[nodiscard]] bool useless() const { return scale[0] == 0 && scale[1] == 0 && scale[2] == 0; }
  [[nodiscard]] simd::Int4 bin(simd::Vec4 middle) const {
    const simd::Vec4 last = simd::splat(static_cast<float>(bins - 1));
    return __builtin_convertvector(simd::min((middle - origin) * scale, last), simd::Int4);
  }
  void fill(Bins& into, std::span<const simd::Primitive> primitives) const {
    for (const simd::Primitive& p : primitives) {
      const simd::Int4 at = bin(p.middle());
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto b = static_cast<std::uint32_t>(at[axis]);
        into.bounds[axis][b].add(p.bounds);
        ++into.count[axis][b];
      }
    }
  }
};

/// The plane with the least sum of half area * count over both sides.
struct Split {
  float cost = std::numeric_limits<float>::infinity();
  std::uint32_t larger = 0;  // count of the larger side: breaks ties, which flat and point-like sets are full of
  int axis = -1;
  std::uint32_t bin = 0;  // the first of the right side
  std::uint32_t left_count = 0;

  void offer(const Split& other) {
    if (other.cost < cost || (other.cost == cost && axis >= 0 && other.larger < larger)) *this = other;
  }
};

inline void sweep_axis(const Bins& bins, std::uint32_t used, int axis, std::uint32_t total, Split& best) {
  const auto a = static_cast<std::size_t>(axis);
  std::array<float, max_bins> right_area;
  simd::Bounds right = simd::Bounds::nothing();
  for (std::uint32_t b = used - 1; b > 0; --b) {
    right.add(bins.bounds[a][b]);
    right_area[b] = right.half_area();
  }
  simd::Bounds left = simd::Bounds::nothing();
  std::uint32_t left_count = 0;
  for (std::uint32_t b = 1; b < used; ++b) {
    left.add(bins.bounds[a][b - 1]);
    left_count += bins.count[a][b - 1];
    const std::uint32_t right_count = total - left_count;
    if (left_count == 0 || right_count == 0) continue;
    const float cost =
        left.half_area() * static_cast<float>(left_count) + right_area[b] * static_cast<float>(right_count);
    best.offer({cost, std::max(left_count, right_count), axis, b, left_count});
  }
}

// So few are sorted and every plane between them is tried: better than bins, and cheaper.
inline constexpr std::uint32_t few = 12;

using Sorted = std::array<std::uint8_t, few>;

inline Sorted sort_few(std::span<const simd::Primitive> primitives, int axis) {
  std::array<float, few> key;
  Sorted place{};
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const float at = primitives[i].middle()[axis];
    std::size_t j = i;
    for (; j > 0 && key[j - 1] > at; --j) {
      key[j] = key[j - 1];
      place[j] = place[j - 1];
    }
    key[j] = at;
    place[j] = static_cast<std::uint8_t>(i);
  }
  return place;
}

/// `Split::bin` is the place of the first primitive on the right, in the order that `sort_few` gives.
inline Split sweep_few(std::span<const simd::Primitive> primitives) {
  Split best;
  const auto count = static_cast<std::uint32_t>(primitives.size());
  for (int axis = 0; axis < 3; ++axis) {
    const Sorted place = sort_few(primitives, axis);
    std::array<float, few> right_area;
    simd::Bounds right = simd::Bounds::nothing(), left = simd::Bounds::nothing();
    for (std::uint32_t i = count - 1; i > 0; --i) {
      right.add(primitives[place[i]].bounds);
      right_area[i] = right.half_area();
    }
    for (std::uint32_t i = 1; i < count; ++i) {
      left.add(primitives[place[i - 1]].bounds);
      const float cost = left.half_area() * static_cast<float>(i) + right_area[i] * static_cast<float>(count - i);
      best.offer({cost, std::max(i, count - i), axis, i, i});
    }
  }
  return best;
}

}  // namespace sheaf
