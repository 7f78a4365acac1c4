// SPDX-License-Identifier: MIT
#include "sampling/pixel_samples.hpp"

#include <cmath>
#include <numbers>

#include "sampling/sobol.hpp"

namespace sheaf {
namespace {

constexpr double radius = 1.5, deviation = 0.5;

double gaussian_integral(double x) {  // from 0 to x, of the filter lowered to 0 at its radius
  const double edge = std::exp(-radius * radius / (2 * deviation * deviation));
  return deviation * std::sqrt(std::numbers::pi / 2) * std::erf(x / (deviation * std::numbers::sqrt2)) - edge * x;
}

double gaussian_offset(double u) {
  const double wanted = (2 * u - 1) * gaussian_integral(radius);
  double low = -radius, high = radius;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (gaussian_integral(middle) < wanted ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

double filter_offset(PixelFilter filter, double u) {
  switch (filter) {
    case PixelFilter::box:
      return u - 0.5;
    case PixelFilter::triangle:
      return u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 * (1 - u));
    case PixelFilter::gaussian:
      return gaussian_offset(u);
  }
  return 0;
}

std::vector<glm::dvec2> pixel_samples(PixelFilter filter, std::uint32_t count) {
  if (count == 1) return {glm::dvec2(0.5)};
  std::vector<glm::dvec2> samples;
  samples.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::dvec2 u = sample_point(SamplePair::pixel, i);
    samples.emplace_back(0.5 + filter_offset(filter, u.x), 0.5 + filter_offset(filter, u.y));
  }
  return samples;
}

}  // namespace sheaf
