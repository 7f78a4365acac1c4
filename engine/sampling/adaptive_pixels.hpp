// SPDX-License-Identifier: MIT
// Spends samples where the error is: rounds that double a pixel's samples until what the last doubling changed, there
// and in the eight pixels around it, is below the error asked for. Which pixels go on depends on whole rounds alone, so
// the picture does not depend on tiles, threads or memory.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace sheaf {

class AdaptivePixels {
 public:
  static constexpr std::uint32_t first_round = 4;  // then 4 more for every pixel, then only where it is worth it

  /// `error`: on a display with gamma 2, white = 1 (and relative above white). `most`: samples of a pixel.
  AdaptivePixels(std::uint32_t width, std::uint32_t height, double error, std::uint32_t most);

  /// The samples of this round: [first, first + count), of every active pixel.
  [[nodiscard]] std::uint32_t first_sample() const { return first_; }
  [[nodiscard]] std::uint32_t samples() const { return count_; }
  [[nodiscard]] bool active(std::size_t pixel) const { return active_[pixel] != 0; }

  /// Adds a pixel's sum over the round's samples: R G B alpha.
  void add(std::size_t pixel, const glm::dvec4& sum) { sums_[pixel] += sum; }

  /// Ends the round. False: the picture is done.
  [[nodiscard]] bool next_round();

  [[nodiscard]] glm::dvec4 mean(std::size_t pixel) const { return sums_[pixel] / static_cast<double>(taken_[pixel]); }
  [[nodiscard]] std::uint32_t taken(std::size_t pixel) const { return taken_[pixel]; }

 private:
  void measure();

  std::uint32_t width_, height_, most_;
  double error_;
  std::uint32_t first_ = 0, count_ = first_round;
  std::vector<glm::dvec4> sums_, before_;  // of all rounds; the mean at the end of the last but one
  std::vector<std::uint32_t> taken_;
  std::vector<std::uint8_t> active_, wrong_;
};

/// What a viewer sees of a change from a to b: the largest difference of square roots, relative where b is above white.
[[nodiscard]] double visible_change(const glm::dvec4& a, const glm::dvec4& b);

}  // namespace sheaf
