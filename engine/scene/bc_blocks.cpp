// SPDX-License-Identifier: MIT
#include "scene/bc_blocks.hpp"

namespace sheaf {
namespace {

using Block = std::span<const std::uint8_t>;

std::uint64_t little_endian(Block block, std::size_t at, unsigned size) {
  std::uint64_t value = 0;
  for (unsigned b = 0; b < size; ++b) value |= std::uint64_t{block[at + b]} << 8 * b;
  return value;
}

std::uint8_t mixed(unsigned a, unsigned b, unsigned weight, unsigned of) {  // to the nearest
  return static_cast<std::uint8_t>((a * (of - weight) + b * weight + of / 2) / of);
}

// Five, six and five bits to eight each.
std::array<std::uint8_t, 4> color_of(std::uint64_t c) {
  const auto r = static_cast<unsigned>(c >> 11 & 31), g = static_cast<unsigned>(c >> 5 & 63),
             b = static_cast<unsigned>(c & 31);
  return {static_cast<std::uint8_t>(r << 3 | r >> 2), static_cast<std::uint8_t>(g << 2 | g >> 4),
          static_cast<std::uint8_t>(b << 3 | b >> 2), 255};
}

// `punch`: of BC1, where the order of the ends says whether there is a transparent index.
void put_colors(Block block, bool punch, BlockTexels& out) {
  const std::uint64_t first = little_endian(block, 0, 2), second = little_endian(block, 2, 2);
  std::array<std::array<std::uint8_t, 4>, 4> palette{color_of(first), color_of(second), {0, 0, 0, 255}, {0, 0, 0, 0}};
  const bool four = !punch || first > second;
  if (four) palette[3][3] = 255;
  for (std::size_t c = 0; c < 3; ++c) {
    palette[2][c] = four ? mixed(palette[0][c], palette[1][c], 1, 3) : mixed(palette[0][c], palette[1][c], 1, 2);
    if (four) palette[3][c] = mixed(palette[0][c], palette[1][c], 2, 3);
  }
  const std::uint64_t indices = little_endian(block, 4, 4);
  for (std::size_t t = 0; t < 16; ++t) out[t] = palette[indices >> 2 * t & 3];
}

void put_ramp(Block block, std::size_t channel, BlockTexels& out) {
  const unsigned first = block[0], second = block[1];
  std::array<std::uint8_t, 8> palette{block[0], block[1]};
  const unsigned steps = first > second ? 7 : 5;
  for (unsigned i = 1; i < steps; ++i) palette[i + 1] = mixed(first, second, i, steps);
  if (steps == 5) palette[7] = 255;
  const std::uint64_t indices = little_endian(block, 2, 6);
  for (std::size_t t = 0; t < 16; ++t) out[t][channel] = palette[indices >> 3 * t & 7];
}

}  // namespace

std::size_t block_bytes(BlockFormat format) {
  return format == BlockFormat::bc1 || format == BlockFormat::bc4 ? 8 : 16;
}

BlockTexels decode_bc(BlockFormat format, Block block) {
  if (format == BlockFormat::bc7) return decode_bc7(block);
  BlockTexels out;
  out.fill({0, 0, 0, 255});
  if (format == BlockFormat::bc1) put_colors(block, true, out);
  if (format == BlockFormat::bc2 || format == BlockFormat::bc3) put_colors(block.subspan(8), false, out);
  if (format == BlockFormat::bc2)
    for (std::size_t t = 0; t < 16; ++t) out[t][3] = static_cast<std::uint8_t>((block[t / 2] >> t % 2 * 4 & 15) * 17);
  if (format == BlockFormat::bc3) put_ramp(block, 3, out);
  if (format == BlockFormat::bc4 || format == BlockFormat::bc5) put_ramp(block, 0, out);
  if (format == BlockFormat::bc5) put_ramp(block.subspan(8), 1, out);
  return out;
}

}  // namespace sheaf
