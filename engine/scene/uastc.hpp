// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace sheaf {

using BlockTexels = std::array<std::array<std::uint8_t, 4>, 16>;  // 4 x 4, row by row, RGBA

/// One block of UASTC (Khronos Data Format Specification 1.4, Universal ASTC), 16 bytes. What is invalid is magenta, as
/// the specification says. `srgb`: the texels are encoded as sRGB, which rounds them differently.
[[nodiscard]] BlockTexels decode_uastc(std::span<const std::uint8_t, 16> block, bool srgb);

}  // namespace sheaf
