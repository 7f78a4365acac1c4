// SPDX-License-Identifier: MIT
// Bounds of the shaders by random search: their operations in single precision, the truth in long double, sizes from
// 1e-30 to 1e30. Every search counts violations a decade; none may be where squares of sizes are floats. How loose a
// bound is on the average, and at the least, is printed and recorded.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "bounds_shaders.hpp"

namespace sheaf::test {

using Real = long double;
using Vec = glm::vec<3, Real>;
using glm::vec3;
constexpr Real ulp = 0x1p-24L;

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  Real range(Real lo, Real hi) { return lo + (hi - lo) * unit_(engine_); }
  Real power(Real lo, Real hi) { return std::pow(Real(10), range(lo, hi)); }
  Vec cube() { return {range(-1, 1), range(-1, 1), range(-1, 1)}; }
  Vec direction() {
    for (;;) {
      const Vec v = cube();
      const Real size = glm::length(v);
      if (size > 0.1L && size <= 1) return v / size;
    }
  }
  /// At `angle` from an axis.
  Vec turned(const Vec& axis, Real angle) {
    const Vec side = glm::normalize(glm::cross(axis, direction()));
    return axis * std::cos(angle) + side * std::sin(angle);
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

inline vec3 unit_float(const Vec& v) { return {glm::normalize(v)}; }

/// Violations by decade of size, and the average of a measure of looseness over the decades that count.
class Search {
 public:
  /// Decades from `least` to `greatest` must be clean, and count for the looseness.
  explicit Search(const char* name, int least = -12, int greatest = 12)
      : name_(name), least_decade_(least), greatest_decade_(greatest) {}
  [[nodiscard]] bool counts(int decade) const { return decade >= least_decade_ && decade <= greatest_decade_; }
  void add(int decade, bool holds) {
    ++tried_[decade];
    violations_[decade] += holds ? 0 : 1;
  }
  void looseness(int decade, Real value) {
    if (!counts(decade)) return;
    sum_ += value;
    least_ = std::min(least_, value);
    ++count_;
  }
  void report() const {
    int lo = 0, hi = 0;
    for (const auto& [decade, bad] : violations_)
      if (counts(decade)) {
        EXPECT_EQ(bad, 0U) << name_ << ": of " << tried_.at(decade) << " of size 1e" << decade;
      }
    while (lo > -30 && clean(lo - 3)) lo -= 3;
    while (hi < 30 && clean(hi + 3)) hi += 3;
    std::printf("%s: holds from 1e%d to 1e%d", name_, lo, hi);
    if (count_ > 0)
      std::printf("; looseness %.3Lg on the average, %.3Lg at the least", sum_ / static_cast<Real>(count_), least_);
    std::printf("\n");
    testing::Test::RecordProperty("holds_from", lo);
    testing::Test::RecordProperty("holds_to", hi);
    if (count_ > 0)
      testing::Test::RecordProperty("looseness", std::to_string(static_cast<double>(sum_ / static_cast<Real>(count_))));
  }

 private:
  [[nodiscard]] bool clean(int decade) const {
    const auto found = violations_.find(decade);
    return found != violations_.end() && found->second == 0;
  }
  const char* name_;
  int least_decade_, greatest_decade_;
  std::map<int, std::size_t> tried_, violations_;
  Real sum_ = 0, least_ = 1e30L;
  std::size_t count_ = 0;
};

template <typename Body>
void over_decades(std::size_t times, Body body) {
  for (int decade = -30; decade <= 30; decade += 3) {
    Dice dice(static_cast<unsigned>(decade + 1000));
    for (std::size_t i = 0; i < times; ++i) body(dice, decade, std::pow(Real(10), decade));
  }
}

inline Real exact_angle(const vec3& a, const vec3& b) {
  return std::atan2(glm::length(glm::cross(Vec(a), Vec(b))), glm::dot(Vec(a), Vec(b)));
}

}  // namespace sheaf::test
