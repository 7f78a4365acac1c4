// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace sheaf {

/// The part of a picture that is rendered at once, in pixels.
struct Tile {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  [[nodiscard]] std::uint32_t pixels() const { return width * height; }
};

}  // namespace sheaf
