// SPDX-License-Identifier: MIT
// Primitives' middles dropped into equal bins along each axis, and the cheapest plane between bins.
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
  simd::Bounds bounds, middles;
};

struct Bins {
  std::array<std::array<simd::Bounds, max_bins>, 3> bounds;
  std::array<std::array<std::uint32_t, max_bins>, 3> count{};

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
  [[nodiscard]] std::uint32_t bin(simd::Vec4 middle, int axis) const { return bin_of((middle - origin) * scale, axis); }
  [[nodiscard]] std::uint32_t bin_of(simd::Vec4 place, int axis) const {
    return std::min(static_cast<std::uint32_t>(place[axis]), bins - 1);
  }
  void fill(Bins& into, std::span<const simd::Primitive> primitives) const {
    for (const simd::Primitive& p : primitives) {
      const simd::Vec4 place = (p.middle() - origin) * scale;
      for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t b = bin_of(place, axis);
        const auto a = static_cast<std::size_t>(axis);
        into.bounds[a][b].add(p.bounds);
        ++into.count[a][b];
      }
    }
  }
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();  // sum of half area * count over both sides
  std::uint32_t larger = 0;  // count of the larger side: breaks ties, which flat and point-like sets are full of
  int axis = -1;
  std::uint32_t bin = 0;  // the first of the right side
  std::uint32_t left_count = 0;
};

inline void sweep_axis(const Bins& bins, std::uint32_t used, int axis, std::uint32_t total, Split& best) {
  const auto a = static_cast<std::size_t>(axis);
  std::array<float, max_bins> right_area{};
  simd::Bounds right;
  for (std::uint32_t b = used - 1; b > 0; --b) {
    right.add(bins.bounds[a][b]);
    right_area[b] = right.half_area();
  }
  simd::Bounds left;
  std::uint32_t left_count = 0;
  for (std::uint32_t b = 1; b < used; ++b) {
    left.add(bins.bounds[a][b - 1]);
    left_count += bins.count[a][b - 1];
    const std::uint32_t right_count = total - left_count;
    if (left_count == 0 || right_count == 0) continue;
    const float cost =
        left.half_area() * static_cast<float>(left_count) + right_area[b] * static_cast<float>(right_count);
    const std::uint32_t larger = std::max(left_count, right_count);
    if (cost < best.cost || (cost == best.cost && best.axis >= 0 && larger < best.larger)) {
      best = {cost, larger, axis, b, left_count};
    }
  }
}

}  // namespace sheaf
