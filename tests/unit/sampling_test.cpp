// SPDX-License-Identifier: MIT
// Where samples lie, and who gets more of them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "sampling/adaptive_pixels.hpp"
#include "sampling/pixel_samples.hpp"
#include "sampling/sobol.hpp"

namespace sheaf {
namespace {

// Every run of 2^k points from a multiple of 2^k has one point in each box of size 2^-j × 2^(j-k).
TEST(Sampling, PointsOfEachPairAreNets) {
  for (std::uint32_t pair = 0; pair < sample_pairs; ++pair)
    for (const std::uint32_t begin : {0U, 64U, 192U, 4096U})
      for (std::uint32_t k = 0; k <= 6; ++k)
        for (std::uint32_t j = 0; j <= k; ++j) {
          std::set<std::pair<int, int>> boxes;
          for (std::uint32_t i = 0; i < 1U << k; ++i) {
            const glm::dvec2 p = sample_point(SamplePair{pair}, begin + i);
            boxes.insert({static_cast<int>(std::ldexp(p.x, static_cast<int>(j))),
                          static_cast<int>(std::ldexp(p.y, static_cast<int>(k - j)))});
          }
          EXPECT_EQ(boxes.size(), 1U << k) << "pair " << pair << ", from " << begin << ", k " << k << ", j " << j;
        }
}

// 64 independent points leave 23 of 64 boxes empty; the same scrambled index in both pairs would leave 56 empty.
TEST(Sampling, PairsAreIndependentOfEachOther) {
  for (std::uint32_t a = 0; a < 2 * sample_pairs; ++a)
    for (std::uint32_t b = 0; b < a - a % 2; ++b) {
      std::set<std::pair<int, int>> boxes;
      double product = 0;
      for (std::uint32_t i = 0; i < 64; ++i) {
        const double x = sample_point(SamplePair{a / 2}, i)[static_cast<int>(a % 2)];
        const double y = sample_point(SamplePair{b / 2}, i)[static_cast<int>(b % 2)];
        boxes.insert({static_cast<int>(8 * x), static_cast<int>(8 * y)});
        product += 12 * (x - 0.5) * (y - 0.5) / 64;
      }
      EXPECT_GE(boxes.size(), 24U) << "dimensions " << a << " and " << b;
      EXPECT_LT(std::abs(product), 0.35) << "dimensions " << a << " and " << b;
    }
}

// The sequence is part of what a picture is: its first points, as they have always been.
TEST(Sampling, PixelPointsStay) {
  const glm::dvec2 first = sample_point(SamplePair::pixel, 0), fifth = sample_point(SamplePair::pixel, 5);
  EXPECT_DOUBLE_EQ(first.x * 0x1p32, 2584794062.0);
  EXPECT_DOUBLE_EQ(first.y * 0x1p32, 3453322835.0);
  EXPECT_DOUBLE_EQ(fifth.x * 0x1p32, 1575361563.0);
  EXPECT_DOUBLE_EQ(fifth.y * 0x1p32, 4081640433.0);
}

TEST(Sampling, LongerListsBeginWithShorterOnes) {
  const auto some = pixel_samples(PixelFilter::gaussian, 7), more = pixel_samples(PixelFilter::gaussian, 300);
  for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i], more[i]);
  EXPECT_EQ(pixel_samples(PixelFilter::triangle, 1), std::vector<glm::dvec2>{glm::dvec2(0.5)});
}

// Moments of the filters, from their formulas integrated here.
TEST(Sampling, OffsetsFollowTheFilter) {
  struct Case {
    PixelFilter filter;
    double radius, variance;
  };
  double weight = 0, spread = 0;
  for (int i = 0; i < 300000; ++i) {
    const double x = (i + 0.5) / 300000 * 3 - 1.5, f = std::exp(-2 * x * x) - std::exp(-4.5);
    weight += f;
    spread += f * x * x;
  }
  for (const auto& c : {Case{PixelFilter::box, 0.5, 1.0 / 12}, Case{PixelFilter::triangle, 1, 1.0 / 6},
                        Case{PixelFilter::gaussian, 1.5, spread / weight}}) {
    double mean = 0, square = 0, last = -c.radius;
    constexpr int n = 20000;
    for (int i = 0; i < n; ++i) {
      const double x = filter_offset(c.filter, (i + 0.5) / n);
      EXPECT_GE(x, last);
      last = x;
      mean += x / n;
      square += x * x / n;
    }
    EXPECT_LE(last, c.radius);
    EXPECT_NEAR(mean, 0, 1e-9);
    EXPECT_NEAR(square, c.variance, 2e-4);
    EXPECT_NEAR(filter_offset(c.filter, 0), -c.radius, 1e-6);
    EXPECT_NEAR(filter_offset(c.filter, 1), c.radius, 1e-6);
  }
}

// The error of an edge through a pixel falls as n^-3/4 (a stratified set's best in the plane); random points give
// n^-1/2.
TEST(Sampling, EdgesConvergeAtTheRateOfANet) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto truth = pixel_samples(PixelFilter::gaussian, 1U << 16U);
  std::vector<double> squared(9, 0);
  for (int edge = 0; edge < 60; ++edge) {
    const double angle = 3.141592653589793 * unit(random), at = unit(random) - 0.5;
    const auto inside = [&](const glm::dvec2& p) {
      return (p.x - 0.5) * std::cos(angle) + (p.y - 0.5) * std::sin(angle) < at;
    };
    double area = 0;
    for (const auto& p : truth) area += inside(p) ? 1.0 / static_cast<double>(truth.size()) : 0;
    for (std::uint32_t k = 2; k <= 8; ++k) {
      double found = 0;
      for (std::uint32_t i = 0; i < 1U << k; ++i) found += inside(truth[i]) ? std::ldexp(1, -static_cast<int>(k)) : 0;
      squared[k] += (found - area) * (found - area);
    }
  }
  const double slope = (std::log2(squared[8]) - std::log2(squared[2])) / 2 / 6;
  EXPECT_LT(slope, -0.68);
  EXPECT_LT(std::sqrt(squared[4] / 60), 0.06);  // 16 samples
}

// A picture with one edge pixel: only it and its neighbours go on, and everyone's mean is over what it took.
TEST(Sampling, AdaptivePixelsGoOnWhereTheMeanChanges) {
  constexpr std::uint32_t side = 9;
  AdaptivePixels pixels(side, side, 0.01, 64);
  const std::size_t centre = 4 * side + 4;
  std::uint32_t rounds = 0;
  do {
    ++rounds;
    for (std::size_t i = 0; i < side * side; ++i) {
      if (!pixels.active(i)) continue;
      const bool flips = i == centre;  // 0, then 1, then 0 …: never settles
      const double value = flips ? static_cast<double>(rounds % 2) : 0.5;
      pixels.add(i, glm::dvec4(value * pixels.samples()));
    }
  } while (pixels.next_round());
  EXPECT_EQ(pixels.taken(centre), 64U);
  EXPECT_EQ(pixels.taken(centre + 1), 64U);
  EXPECT_EQ(pixels.taken(centre - side - 1), 64U);
  EXPECT_EQ(pixels.taken(centre + 2), 8U);
  EXPECT_EQ(pixels.taken(0), 8U);
  EXPECT_DOUBLE_EQ(pixels.mean(0).r, 0.5);
  EXPECT_GT(pixels.mean(centre).r, 0);
  EXPECT_LT(pixels.mean(centre).r, 1);
}

TEST(Sampling, TheMostSamplesNeedNotBeAPowerOfTwo) {
  AdaptivePixels pixels(1, 1, 1e-5, 21);
  std::uint32_t taken = 0, rounds = 0;
  do {
    taken += pixels.samples();
    pixels.add(0, glm::dvec4(rounds++ % 2 == 0 ? 1.0 * pixels.samples() : 0));
  } while (pixels.next_round());
  EXPECT_EQ(taken, 21U);
  EXPECT_EQ(pixels.taken(0), 21U);
}

TEST(Sampling, VisibleChangeIsOfSquareRootsAndRelativeAboveWhite) {
  EXPECT_DOUBLE_EQ(visible_change({0.25, 0, 0, 1}, {0.36, 0, 0, 1}), 0.1);
  EXPECT_DOUBLE_EQ(visible_change({0, 64, 0, 1}, {0, 100, 0, 1}), 0.2);
  EXPECT_DOUBLE_EQ(visible_change({0, 0, 0, 0.25}, {0, 0, 0, 1}), 0.5);
}

}  // namespace
}  // namespace sheaf
