// SPDX-License-Identifier: MIT
// Blocks of 4 x 4 texels, and images that are made of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "scene/scene.hpp"

namespace sheaf {

using BlockTexels = std::array<std::array<std::uint8_t, 4>, 16>;  // row by row, RGBA

[[nodiscard]] inline std::uint64_t block_count(std::uint64_t width, std::uint64_t height) {
  return (width + 3) / 4 * ((height + 3) / 4);
}

/// Blocks of `size` bytes, row by row: `decode` makes texels of each, of which those inside are kept. `level` has all
/// of them.
template <class Decode>
void decode_blocks(std::span<const std::uint8_t> level, std::size_t size, Image& image, const Decode& decode) {
  for (std::uint32_t y = 0; y < image.height; y += 4) {
    for (std::uint32_t x = 0; x < image.width; x += 4, level = level.subspan(size)) {
      const BlockTexels texels = decode(level.first(size));
      for (std::uint32_t row = 0; row < std::min(4u, image.height - y); ++row)
        for (std::uint32_t column = 0; column < std::min(4u, image.width - x); ++column)
          std::ranges::copy(texels[row * 4 + column],
                            &image.rgba[(std::size_t{y + row} * image.width + x + column) * 4]);
    }
  }
}

}  // namespace sheaf
