// SPDX-License-Identifier: MIT
// The coordinates of samples: two dimensions of Sobol's sequence, scrambled anew for each pair of coordinates, so that
// a sample has as many dimensions as there are things to sample (Burley, "Practical Hash-based Owen Scrambling", JCGT
// 2020: padding).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace sheaf {

enum class SamplePair : std::uint32_t {
  pixel,        // the place in the pixel
  lens,         // on the aperture
  time,         // within the shutter; the second coordinate is free
  environment,  // a direction
  light,        // a point on a punctual light's sphere or disc
  emitter,      // a point on emissive surfaces
  glossy,       // a microfacet's normal
  wavelength,   // the second coordinate is free
};
inline constexpr std::uint32_t sample_pairs = 8;

/// Point `index` of a pair's sequence in [0, 1)². Every run of 2^k points that begins at a multiple of 2^k is a
/// (0, k, 2)-net: it has one point in each of the 2^k boxes of size 2^-j × 2^(j-k), for every j. Points of the same
/// index in two pairs are as good as independent.
[[nodiscard]] glm::dvec2 sample_point(SamplePair pair, std::uint32_t index);

}  // namespace sheaf
