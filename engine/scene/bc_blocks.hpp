// SPDX-License-Identifier: MIT
// The block compression of Direct3D (BC1 to BC5 of unsigned numbers, BC7), as the Khronos Data Format Specification
// describes it.
#pragma once

#include "scene/block_texels.hpp"

namespace sheaf {

enum class BlockFormat { bc1, bc2, bc3, bc4, bc5, bc7 };

[[nodiscard]] std::size_t block_bytes(BlockFormat format);

/// Channels that the format lacks are 0, and alpha is 255.
[[nodiscard]] BlockTexels decode_bc(BlockFormat format, std::span<const std::uint8_t> block);

[[nodiscard]] BlockTexels decode_bc7(std::span<const std::uint8_t> block);

}  // namespace sheaf
