// SPDX-License-Identifier: MIT
#include "sampling/adaptive_pixels.hpp"

#include <algorithm>
#include <cmath>

namespace sheaf {

double visible_change(const glm::dvec4& a, const glm::dvec4& b) {
  double most = 0;
  for (int c = 0; c < 4; ++c) {
    const double before = std::sqrt(std::max(a[c], 0.0)), now = std::sqrt(std::max(b[c], 0.0));
    most = std::max(most, std::abs(now - before) / std::max(now, 1.0));
  }
  return most;
}

AdaptivePixels::AdaptivePixels(std::uint32_t width, std::uint32_t height, double error, std::uint32_t most)
    : width_(width), height_(height), most_(most), error_(error), count_(std::min(first_round, most)) {
  const std::size_t pixels = std::size_t{width} * height;
  sums_.assign(pixels, glm::dvec4(0));
  before_ = sums_;
  taken_.assign(pixels, 0);
  active_.assign(pixels, 1);
  wrong_.assign(pixels, 0);
}

void AdaptivePixels::measure() {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (active_[i] == 0) continue;  // what did not go on keeps what it was found to be
    taken_[i] += count_;
    const glm::dvec4 now = mean(i);
    wrong_[i] = visible_change(before_[i], now) > error_ ? 1 : 0;
    before_[i] = now;
  }
}

bool AdaptivePixels::next_round() {
  measure();
  const bool measured = first_ != 0;  // one round alone says nothing about error
  first_ += count_;
  if (first_ >= most_) return false;
  count_ = std::min(first_, most_ - first_);
  if (!measured) return true;
  bool any = false;
  // A pixel that stopped has fewer samples than the round begins after, and never goes on.
  std::vector<std::uint8_t> next(active_.size(), 0);
  for (std::uint32_t y = 0; y < height_; ++y)
    for (std::uint32_t x = 0; x < width_; ++x) {
      const std::size_t at = std::size_t{y} * width_ + x;
      if (active_[at] == 0) continue;
      bool wrong = false;
      for (std::uint32_t v = y == 0 ? 0 : y - 1; v <= std::min(y + 1, height_ - 1); ++v)
        for (std::uint32_t u = x == 0 ? 0 : x - 1; u <= std::min(x + 1, width_ - 1); ++u)
          wrong = wrong || (wrong_[std::size_t{v} * width_ + u] != 0 && active_[std::size_t{v} * width_ + u] != 0);
      next[at] = wrong ? 1 : 0;
      any = any || wrong;
    }
  active_ = std::move(next);
  return any;
}

}  // namespace sheaf
