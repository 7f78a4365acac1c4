// SPDX-License-Identifier: MIT
#pragma once

#include "scene/block_texels.hpp"

namespace sheaf {

/// One block of UASTC (Khronos Data Format Specification 1.4, Universal ASTC), 16 bytes. What is invalid is magenta, as
/// the specification says. `srgb`: the texels are encoded as sRGB, which rounds them differently.
[[nodiscard]] BlockTexels decode_uastc(std::span<const std::uint8_t, 16> block, bool srgb);

}  // namespace sheaf
