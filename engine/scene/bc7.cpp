// SPDX-License-Identifier: MIT
#include <bit>

#include "scene/bc_blocks.hpp"
#include "scene/bit_reader.hpp"

namespace sheaf {
namespace {

// Of each texel two bits: the subset that it belongs to, by the number of the pattern.
constexpr std::uint32_t two_subsets[64] = {
    0x50505050, 0x40404040, 0x54545454, 0x54505040, 0x50404000, 0x55545450, 0x55545040, 0x54504000,
    0x50400000, 0x55555450, 0x55544000, 0x54400000, 0x55555440, 0x55550000, 0x55555500, 0x55000000,
    0x55150100, 0x00004054, 0x15010000, 0x00405054, 0x00004050, 0x15050100, 0x05010000, 0x40505054,
    0x00404050, 0x05010100, 0x14141414, 0x05141450, 0x01155440, 0x00555500, 0x15014054, 0x05414150,
    0x44444444, 0x55005500, 0x11441144, 0x05055050, 0x05500550, 0x11114444, 0x41144114, 0x44111144,
    0x15055054, 0x01055040, 0x05041050, 0x05455150, 0x14414114, 0x50050550, 0x41411414, 0x00141400,
    0x00041504, 0x00105410, 0x10541000, 0x04150400, 0x50410514, 0x41051450, 0x05415014, 0x14054150,
    0x41050514, 0x41505014, 0x40011554, 0x54150140, 0x50505500, 0x00555050, 0x15151010, 0x54540404,
};
constexpr std::uint32_t three_subsets[64] = {
    0xaa685050, 0x6a5a5040, 0x5a5a4200, 0x5450a0a8, 0xa5a50000, 0xa0a05050, 0x5555a0a0, 0x5a5a5050,
    0xaa550000, 0xaa555500, 0xaaaa5500, 0x90909090, 0x94949494, 0xa4a4a4a4, 0xa9a59450, 0x2a0a4250,
    0xa5945040, 0x0a425054, 0xa5a5a500, 0x55a0a0a0, 0xa8a85454, 0x6a6a4040, 0xa4a45000, 0x1a1a0500,
    0x0050a4a4, 0xaaa59090, 0x14696914, 0x69691400, 0xa08585a0, 0xaa821414, 0x50a4a450, 0x6a5a0200,
    0xa9a58000, 0x5090a0a8, 0xa8a09050, 0x24242424, 0x00aa5500, 0x24924924, 0x24499224, 0x50a50a50,
    0x500aa550, 0xaaaa4444, 0x66660000, 0xa5a0a5a0, 0x50a050a0, 0x69286928, 0x44aaaa44, 0x66666600,
    0xaa444444, 0x54a854a8, 0x95809580, 0x96969600, 0xa85454a8, 0x80959580, 0xaa141414, 0x96960000,
    0xaaaa1414, 0xa05050a0, 0xa0a5a5a0, 0x96000000, 0x40804080, 0xa9a8a9a8, 0xaaaaaa44, 0x2a4a5254,
};
// The texel of the second and of the third subset whose index lacks its highest bit; of the first it is texel 0.
constexpr std::uint8_t anchor_of_two[64] = {15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15,
                                            15, 2,  8,  2,  2,  8,  8,  15, 2,  8,  2,  2,  8,  8,  2,  2,
                                            15, 15, 6,  8,  2,  8,  15, 15, 2,  8,  2,  2,  2,  15, 15, 6,
                                            6,  2,  6,  8,  15, 15, 2,  2,  15, 15, 15, 15, 15, 2,  2,  15};
constexpr std::uint8_t second_anchor_of_three[64] = {
    3, 3,  15, 15, 8, 3,  15, 15, 8,  8, 6,  6, 6,  5,  3,  3,  3, 3,  8, 15, 3, 3, 6, 10, 5, 8,  8, 6,  8,  5,  15, 15,
    8, 15, 3,  5,  6, 10, 8,  15, 15, 3, 15, 5, 15, 15, 15, 15, 3, 15, 5, 5,  5, 8, 5, 10, 5, 10, 8, 13, 15, 12, 3,  3,
};
constexpr std::uint8_t third_anchor_of_three[64] = {
    15, 8, 8, 3,  15, 15, 3,  8,  15, 15, 15, 15, 15, 15, 15, 8,  15, 8,  15, 3,  15, 8,
    15, 8, 3, 15, 6,  10, 15, 15, 10, 8,  15, 3,  15, 10, 10, 8,  9,  10, 6,  15, 8,  15,
    3,  6, 6, 8,  15, 3,  15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 3,  15, 15, 8,
};
struct Mode {
  unsigned subsets, pattern_bits, rotation_bits, selection_bits, color_bits, alpha_bits;
  bool own_low_bits, shared_low_bits;  // the lowest bit of an endpoint's channels, for each or for a subset's two
  unsigned index_bits, second_index_bits;
};
constexpr Mode modes[8] = {
    {3, 4, 0, 0, 4, 0, true, false, 3, 0},  {2, 6, 0, 0, 6, 0, false, true, 3, 0},
    {3, 6, 0, 0, 5, 0, false, false, 2, 0}, {2, 6, 0, 0, 7, 0, true, false, 2, 0},
    {1, 0, 2, 1, 5, 6, false, false, 2, 3}, {1, 0, 2, 0, 7, 8, false, false, 2, 2},
    {1, 0, 0, 0, 7, 7, true, false, 4, 0},  {2, 6, 0, 0, 5, 5, true, false, 2, 0},
};

unsigned weight_of(unsigned index, unsigned bits) {
  static constexpr std::array<std::uint8_t, 4> two{0, 21, 43, 64};
  static constexpr std::array<std::uint8_t, 8> three{0, 9, 18, 27, 37, 46, 55, 64};
  static constexpr std::array<std::uint8_t, 16> four{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};
  return bits == 2 ? two[index] : bits == 3 ? three[index] : four[index];
}

using Endpoints = std::array<std::array<unsigned, 4>, 6>;  // two for each subset, RGBA

void read_channel(BitReader& in, unsigned count, unsigned bits, std::size_t channel, Endpoints& out) {
  for (unsigned e = 0; e < count; ++e) out[e][channel] = in.bits(bits);
}

Endpoints read_endpoints(BitReader& in, const Mode& mode) {
  Endpoints out{};
  const unsigned count = 2 * mode.subsets;
  for (std::size_t c = 0; c < 3; ++c) read_channel(in, count, mode.color_bits, c, out);
  if (mode.alpha_bits > 0) read_channel(in, count, mode.alpha_bits, 3, out);
  const bool low_bits = mode.own_low_bits || mode.shared_low_bits;
  std::array<unsigned, 6> low{};
  for (unsigned e = 0; e < count; ++e) {
    if (mode.own_low_bits) low[e] = in.bit();
    if (mode.shared_low_bits) low[e] = e % 2 == 0 ? in.bit() : low[e - 1];
  }
  for (unsigned e = 0; e < count; ++e) {
    for (std::size_t c = 0; c < 4; ++c) {
      const unsigned stored = c < 3 ? mode.color_bits : mode.alpha_bits;
      if (stored == 0) {
        out[e][c] = 255;
        continue;
      }
      const unsigned bits = stored + (low_bits ? 1 : 0);
      const unsigned value = low_bits ? out[e][c] << 1 | low[e] : out[e][c];
      out[e][c] = (value << (8 - bits) | value >> (2 * bits - 8)) & 255;
    }
  }
  return out;
}

struct Pattern {
  std::uint32_t of_texels = 0;
  std::array<unsigned, 3> anchors{};
  [[nodiscard]] std::size_t subset(std::size_t texel) const { return of_texels >> 2 * texel & 3; }
};

Pattern pattern_of(unsigned subsets, unsigned number) {
  if (subsets == 2) return {two_subsets[number], {0, anchor_of_two[number], 0}};
  if (subsets == 3) return {three_subsets[number], {0, second_anchor_of_three[number], third_anchor_of_three[number]}};
  return {};
}

std::array<unsigned, 16> read_indices(BitReader& in, unsigned bits, const Pattern& pattern) {
  std::array<unsigned, 16> out{};
  for (unsigned t = 0; t < 16; ++t) out[t] = in.bits(t == pattern.anchors[pattern.subset(t)] ? bits - 1 : bits);
  return out;
}

}  // namespace

BlockTexels decode_bc7(std::span<const std::uint8_t> block) {
  BlockTexels out{};
  if (block[0] == 0) return out;  // reserved
  BitReader in(block);
  const auto number = static_cast<unsigned>(std::countr_zero(block[0]));
  (void)in.bits(number + 1);
  const Mode& mode = modes[number];
  const Pattern pattern = pattern_of(mode.subsets, in.bits(mode.pattern_bits));
  const unsigned rotation = in.bits(mode.rotation_bits), swapped = in.bits(mode.selection_bits);
  const Endpoints ends = read_endpoints(in, mode);
  const std::array<unsigned, 16> first = read_indices(in, mode.index_bits, pattern);
  const bool two = mode.second_index_bits > 0;
  const std::array<unsigned, 16> second = two ? read_indices(in, mode.second_index_bits, {}) : first;
  const unsigned second_bits = two ? mode.second_index_bits : mode.index_bits;
  for (std::size_t t = 0; t < 16; ++t) {
    const std::size_t e = 2 * pattern.subset(t);
    const unsigned a = weight_of(first[t], mode.index_bits), b = weight_of(second[t], second_bits);
    for (std::size_t c = 0; c < 4; ++c) {
      const unsigned w = (c == 3) != (swapped != 0) ? b : a;
      out[t][c] = static_cast<std::uint8_t>((ends[e][c] * (64 - w) + ends[e + 1][c] * w + 32) >> 6);
    }
    if (rotation > 0) std::swap(out[t][3], out[t][rotation - 1]);
  }
  return out;
}

}  // namespace sheaf
