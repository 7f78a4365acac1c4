// SPDX-License-Identifier: MIT
// The levels of a texture, each half as wide and high as the one before, for filtered lookups.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace sheaf {

enum class MipContent : std::uint32_t {
  data,            // four independent numbers
  color,           // sRGB colour: averaged as light
  color_by_alpha,  // the same, weighted by alpha: what is cut out lends its neighbours no colour
};

/// Appends the image and its smaller levels, `levels` in all, as RGBA8 words. Level k is max(1, width >> k) wide; a
/// texel is the mean of the part of the level before that it covers.
void append_mip_levels(const Image& image, MipContent content, std::uint32_t levels,
                       std::vector<std::uint32_t>& texels);

}  // namespace sheaf
