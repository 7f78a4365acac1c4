// SPDX-License-Identifier: MIT
// Where the samples of a pixel lie (SHADING.md, Samples): an Owen-scrambled Sobol' sequence, spread as the
// reconstruction filter wants it (Ernst, Stamminger, Greiner, "Filter Importance Sampling", 2006), so that a pixel is
// the plain mean of its own samples and no picture depends on how it is cut into tiles.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace sheaf {

enum class PixelFilter : std::uint32_t {
  box,       // a pixel's own square
  triangle,  // radius 1
  gaussian,  // standard deviation 0.5, cut at 1.5 and lowered to be 0 there
};
constexpr auto choice_names(PixelFilter) { return std::array{"box", "triangle", "gaussian"}; }

/// The offset from a pixel's centre, in pixels, below which the share u of the filter's weight lies. 0 ≤ u ≤ 1.
[[nodiscard]] double filter_offset(PixelFilter filter, double u);

/// The first `count` places, in pixels from the pixel's upper left corner, x to the right and y down. One sample lies
/// at the centre. A longer list begins with the shorter ones, from two samples on.
[[nodiscard]] std::vector<glm::dvec2> pixel_samples(PixelFilter filter, std::uint32_t count);

}  // namespace sheaf
