// SPDX-License-Identifier: MIT
#include "scene/uastc.hpp"

#include <algorithm>

#include "scene/bit_reader.hpp"

namespace sheaf {
namespace {

// Of each texel two bits: the subset that it belongs to, by the number of the pattern.
constexpr std::uint32_t two_subsets[] = {0x50505050, 0x40404040, 0x01010101, 0x54505040, 0x05151555, 0x55545450,
                                         0x00010515, 0x01051555, 0x50400000, 0x00000105, 0x55544000, 0x01155555,
                                         0x00000115, 0x00005555, 0x55555500, 0x00555555, 0x55551501, 0x40545555,
                                         0x00405054, 0x00004050, 0x15050100, 0x50545555, 0x15050501, 0x00404050,
                                         0x50545455, 0x14141414, 0x55000055, 0x11111111, 0x00550055, 0x05145041};
constexpr std::uint32_t two_subsets_mode_7[] = {0x00005500, 0x10101010, 0x00010505, 0x50504000, 0x55005555,
                                                0x04040404, 0x55555040, 0x50505054, 0x05500005, 0x00005454,
                                                0x15150000, 0x05000005, 0x00005054, 0x55554000, 0x14555555,
                                                0x01050505, 0x01015555, 0x01051450, 0x00005455};
constexpr std::uint32_t three_subsets[] = {0xa5a50000, 0xaa005555, 0xaa000055, 0x0000aa55, 0x25252525, 0x94949494,
                                           0x58585858, 0x56560202, 0x92929292, 0x55aa0055, 0xa05050a0};

struct ModeCode {
  unsigned bits, length, mode;
};
constexpr ModeCode mode_codes[] = {{0x00, 2, 11}, {0x02, 3, 10}, {0x06, 3, 12}, {0x01, 4, 0},  {0x09, 4, 18},
                                   {0x03, 5, 3},  {0x07, 5, 7},  {0x0b, 5, 5},  {0x0d, 5, 14}, {0x0f, 5, 9},
                                   {0x13, 5, 4},  {0x17, 5, 8},  {0x1b, 5, 6},  {0x1d, 5, 2},  {0x1f, 5, 13},
                                   {0x15, 6, 16}, {0x25, 6, 17}, {0x35, 6, 1},  {0x05, 7, 15}};
constexpr unsigned solid_mode = 8;

struct Mode {
  unsigned endpoint_bits, trits, quints, weight_bits;  // `trits`, `quints`: an endpoint value has one of that kind
  unsigned channels;                                   // 3: RGB, 4: RGBA, 2: luminance and alpha
  unsigned subsets, pattern_bits;
  bool two_planes, chosen_plane;  // `chosen_plane`: a field says which channel has weights of its own
};
constexpr Mode modes[19] = {
    {6, 1, 0, 4, 3, 1, 0, false, false}, {8, 0, 0, 2, 3, 1, 0, false, false}, {4, 0, 0, 3, 3, 2, 5, false, false},
    {2, 1, 0, 2, 3, 3, 4, false, false}, {3, 0, 1, 2, 3, 2, 5, false, false}, {8, 0, 0, 3, 3, 1, 0, false, false},
    {5, 0, 1, 2, 3, 1, 0, true, true},   {3, 0, 1, 2, 3, 2, 5, false, false}, {},
    {4, 0, 0, 2, 4, 2, 5, false, false}, {4, 1, 0, 4, 4, 1, 0, false, false}, {4, 1, 0, 2, 4, 1, 0, true, true},
    {6, 1, 0, 3, 4, 1, 0, false, false}, {8, 0, 0, 1, 4, 1, 0, true, true},   {8, 0, 0, 2, 4, 1, 0, false, false},
    {8, 0, 0, 4, 2, 1, 0, false, false}, {8, 0, 0, 2, 2, 2, 5, false, false}, {8, 0, 0, 2, 2, 1, 0, true, false},
    {5, 0, 0, 5, 3, 1, 0, false, false},
};

using Texel = std::array<std::uint8_t, 4>;

BlockTexels filled(const Texel& texel) {
  BlockTexels out;
  out.fill(texel);
  return out;
}
BlockTexels invalid() { return filled({255, 0, 255, 255}); }

// To eight bits by repeating the bits that there are.
unsigned replicated(unsigned value, unsigned bits, unsigned to) {
  unsigned out = 0;
  for (int shift = static_cast<int>(to) - static_cast<int>(bits); shift > -static_cast<int>(bits);
       shift -= static_cast<int>(bits))
    out |= shift >= 0 ? value << shift : value >> -shift;
  return out;
}

// How the bits above the lowest one are spread over nine (`shifts` says where b, c, … go), and the weight of the digit.
// From ASTC's unquantization of endpoints.
unsigned unquantized(unsigned digit, unsigned bits, unsigned count, bool is_trit) {
  const auto bit = [&](unsigned n) { return bits >> n & 1u; };
  unsigned spread = 0, weight = 0;
  if (is_trit && count == 2) spread = bit(1) * 0x116, weight = 93;
  if (is_trit && count == 4) spread = bit(3) * 0x104 + bit(2) * 0x082 + bit(1) * 0x041, weight = 22;
  if (is_trit && count == 6)
    spread = bit(5) * 0x101 + bit(4) * 0x080 + bit(3) * 0x040 + bit(2) * 0x020 + bit(1) * 0x010, weight = 5;
  if (!is_trit && count == 3) spread = bit(2) * 0x105 + bit(1) * 0x082, weight = 26;
  if (!is_trit && count == 5) spread = bit(4) * 0x101 + bit(3) * 0x080 + bit(2) * 0x040 + bit(1) * 0x020, weight = 6;
  const unsigned all = bit(0) * 0x1ff;
  return (all & 0x80) | ((digit * weight + spread) ^ all) >> 2;
}

unsigned weight_of(unsigned value, unsigned bits) {
  const unsigned wide = replicated(value, bits, 6);
  return wide > 32 ? wide + 1 : wide;
}

struct Endpoints {
  std::array<std::array<Texel, 2>, 3> of_subset;  // low and high
};

class Block {
 public:
  Block(BitReader& reader, unsigned mode) : in_(reader), number_(mode), mode_(modes[mode]) {}

  [[nodiscard]] BlockTexels decode(bool srgb) {
    if (!read_configuration()) return invalid();
    const Endpoints endpoints = read_endpoints();
    const std::array<std::array<unsigned, 16>, 2> weights = read_weights();
    BlockTexels out;
    for (std::size_t i = 0; i < 16; ++i) {
      const auto& [low, high] = endpoints.of_subset[subset(i)];
      for (std::size_t c = 0; c < 4; ++c) {
        const unsigned w = weights[mode_.two_planes && c == plane_channel_ ? 1 : 0][i];
        const unsigned l = low[c] << 8 | (srgb ? 0x80u : low[c]), h = high[c] << 8 | (srgb ? 0x80u : high[c]);
        out[i][c] = static_cast<std::uint8_t>((l * (64 - w) + h * w + 32) >> 14);
      }
    }
    return out;
  }

 private:
  // Hints for transcoders are passed over; false where the block is invalid.
  [[nodiscard]] bool read_configuration() {
    const bool has_alpha = number_ >= 9 && number_ <= 17, is_short = number_ >= 10 && number_ <= 12;
    (void)in_.bits(is_short ? 1 + 8 : 2 + 8 + 5);
    if (has_alpha) {
      (void)in_.bits(4);
      if (in_.bits(4) == 0) return false;
    }
    if (mode_.subsets > 1) {
      const unsigned pattern = in_.bits(mode_.pattern_bits);
      const std::span<const std::uint32_t> patterns = number_ == 3 ? std::span<const std::uint32_t>(three_subsets)
                                                      : number_ == 7
                                                          ? std::span<const std::uint32_t>(two_subsets_mode_7)
                                                          : std::span<const std::uint32_t>(two_subsets);
      if (pattern >= patterns.size()) return false;
      pattern_ = patterns[pattern];
    }
    plane_channel_ = mode_.chosen_plane ? in_.bits(2) : 3;
    return true;
  }

  [[nodiscard]] std::size_t subset(std::size_t texel) const { return pattern_ >> 2 * texel & 3u; }

  [[nodiscard]] Endpoints read_endpoints() {
    const unsigned count = 2 * mode_.channels * mode_.subsets;
    std::array<unsigned, 18> digits{};
    if (mode_.trits != 0) read_digits(digits, count, 3, 5, {2, 4, 5, 7, 8});
    if (mode_.quints != 0) read_digits(digits, count, 5, 3, {3, 5, 7, 0, 0});
    Endpoints out;
    for (unsigned s = 0, next = 0; s < mode_.subsets; ++s) {
      for (auto& end : out.of_subset[s]) end[3] = 255;
      for (unsigned c = 0; c < mode_.channels; ++c)
        for (unsigned end = 0; end < 2; ++end, ++next) put(out.of_subset[s][end], c, value(digits[next]));
    }
    return out;
  }

  // `per` digits of base `base` lie in one number, of `sizes[n - 1]` bits where there are n.
  void read_digits(std::array<unsigned, 18>& digits, unsigned count, unsigned base, unsigned per,
                   const std::array<unsigned, 5>& sizes) {
    for (unsigned at = 0; at < count; at += per) {
      const unsigned here = std::min(per, count - at);
      unsigned packed = in_.bits(sizes[here - 1]);
      for (unsigned d = 0; d < here; ++d, packed /= base) digits[at + d] = packed % base;
    }
  }

  [[nodiscard]] std::uint8_t value(unsigned digit) {
    const unsigned bits = in_.bits(mode_.endpoint_bits);
    const unsigned eight = mode_.trits + mode_.quints == 0
                               ? replicated(bits, mode_.endpoint_bits, 8)
                               : unquantized(digit, bits, mode_.endpoint_bits, mode_.trits != 0);
    return static_cast<std::uint8_t>(eight);
  }

  void put(Texel& end, unsigned channel, std::uint8_t value) const {
    if (mode_.channels > 2) {
      end[channel] = value;
    } else if (channel == 0) {
      end[0] = end[1] = end[2] = value;
    } else {
      end[3] = value;
    }
  }

  // The first texel of each subset has a highest bit of 0, which is not stored.
  [[nodiscard]] std::array<std::array<unsigned, 16>, 2> read_weights() {
    std::array<std::array<unsigned, 16>, 2> out{};
    std::array<bool, 4> seen{};
    for (std::size_t i = 0; i < 16; ++i) {
      const bool first = !seen[subset(i)];
      seen[subset(i)] = true;
      for (std::size_t plane = 0; plane < (mode_.two_planes ? 2 : 1); ++plane)
        out[plane][i] = weight_of(in_.bits(mode_.weight_bits - (first ? 1 : 0)), mode_.weight_bits);
    }
    return out;
  }

  BitReader& in_;
  unsigned number_;
  const Mode& mode_;
  std::uint32_t pattern_ = 0;
  unsigned plane_channel_ = 3;
};

}  // namespace

BlockTexels decode_uastc(std::span<const std::uint8_t, 16> block, bool srgb) {
  const auto* const code = std::ranges::find_if(
      mode_codes, [&](const ModeCode& one) { return (block[0] & ((1u << one.length) - 1)) == one.bits; });
  if (code == std::end(mode_codes)) return invalid();
  BitReader reader(block);
  (void)reader.bits(code->length);
  if (code->mode != solid_mode) return Block(reader, code->mode).decode(srgb);
  Texel texel;
  for (std::uint8_t& channel : texel) channel = static_cast<std::uint8_t>(reader.bits(8));
  return filled(texel);
}

}  // namespace sheaf
