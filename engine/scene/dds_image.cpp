// SPDX-License-Identifier: MIT
// DirectDraw Surface files: the finest level of a two-dimensional image.
#include <array>
#include <optional>
#include <string_view>

#include "scene/bc_blocks.hpp"
#include "scene/image_codec.hpp"

namespace sheaf {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t head_size = 128, extended_head_size = 148;

struct Fault {
  std::string reason;
};

std::uint32_t word(Bytes file, std::size_t at) {
  return file[at] | std::uint32_t{file[at + 1]} << 8 | std::uint32_t{file[at + 2]} << 16 |
         std::uint32_t{file[at + 3]} << 24;
}

struct Dds {
  std::uint32_t width = 0, height = 0;
  std::optional<BlockFormat> blocks;          // else four bytes for each texel
  std::array<unsigned, 4> order{0, 1, 2, 3};  // of plain texels: which byte is red, green, blue, alpha
  bool opaque = false;
  Bytes level;
};

struct Named {
  std::string_view name;
  BlockFormat format;
};
constexpr Named four_letters[] = {{"DXT1", BlockFormat::bc1}, {"DXT2", BlockFormat::bc2}, {"DXT3", BlockFormat::bc2},
                                  {"DXT4", BlockFormat::bc3}, {"DXT5", BlockFormat::bc3}, {"ATI1", BlockFormat::bc4},
                                  {"BC4U", BlockFormat::bc4}, {"ATI2", BlockFormat::bc5}, {"BC5U", BlockFormat::bc5}};

struct Numbered {  // DXGI_FORMAT, from UNORM to UNORM_SRGB
  std::uint32_t first, last;
  BlockFormat format;
};
constexpr Numbered numbers[] = {{71, 72, BlockFormat::bc1}, {74, 75, BlockFormat::bc2}, {77, 78, BlockFormat::bc3},
                                {80, 80, BlockFormat::bc4}, {83, 83, BlockFormat::bc5}, {98, 99, BlockFormat::bc7}};

void read_numbered(std::uint32_t number, Dds& out) {
  for (const Numbered& one : numbers)
    if (number >= one.first && number <= one.last) out.blocks = one.format;
  if (out.blocks || number == 28 || number == 29) return;  // R8G8B8A8
  if (number != 87 && number != 88 && number != 91 && number != 93)
    throw Fault{"is a DDS file of the DXGI format " + std::to_string(number) + ", which is not supported"};
  out.order = {2, 1, 0, 3};
  out.opaque = number == 88 || number == 93;
}

// 32 bits for each texel, of which masks say the channels.
void read_masks(Bytes file, Dds& out) {
  constexpr std::uint32_t has_alpha = 1;
  const std::uint32_t bits = word(file, 88);
  out.opaque = (word(file, 80) & has_alpha) == 0;
  for (std::size_t c = 0; c < 4; ++c) {
    if (c == 3 && out.opaque) continue;
    const std::uint32_t mask = word(file, 92 + 4 * c);
    std::optional<unsigned> byte;
    for (unsigned b = 0; b < 4; ++b)
      if (mask == 0xffu << 8 * b) byte = b;
    if (bits != 32 || !byte) throw Fault{"is a DDS file whose plain texels are not of four bytes"};
    out.order[c] = *byte;
  }
}

Dds parse(Bytes file) {
  constexpr std::uint32_t is_named = 4, is_cube = 0x200, is_volume = 0x200000;
  if (file.size() < head_size) throw Fault{"is a DDS file that is cut short"};
  Dds out;
  out.height = word(file, 12);
  out.width = word(file, 16);
  if (out.width == 0 || out.height == 0 || (word(file, 112) & (is_cube | is_volume)) != 0)
    throw Fault{"is a DDS file that does not hold a two-dimensional image"};
  const std::string_view name(reinterpret_cast<const char*>(&file[84]), 4);
  const bool named = (word(file, 80) & is_named) != 0, extended = named && name == "DX10";
  if (extended) {
    if (file.size() < extended_head_size) throw Fault{"is a DDS file that is cut short"};
    read_numbered(word(file, 128), out);
  } else if (named) {
    for (const Named& one : four_letters)
      if (name == one.name) out.blocks = one.format;
    if (!out.blocks) throw Fault{"is a DDS file of a format that is not supported: BC1 to BC5 and BC7 are"};
  } else {
    read_masks(file, out);
  }
  const std::uint64_t size = out.blocks ? block_count(out.width, out.height) * block_bytes(*out.blocks)
                                        : std::uint64_t{out.width} * out.height * 4;
  const Bytes rest = file.subspan(extended ? extended_head_size : head_size);
  if (rest.size() < size) throw Fault{"is a DDS file that is cut short"};
  out.level = rest.first(size);
  return out;
}

}  // namespace

ImageHead read_dds_head(Bytes file) {
  try {
    const Dds dds = parse(file);
    return {dds.width, dds.height, {}};
  } catch (const Fault& fault) {
    return {0, 0, fault.reason};
  }
}

std::string decode_dds(Bytes file, Image& image) {
  try {
    const Dds dds = parse(file);
    image.rgba.resize(std::size_t{image.width} * image.height * 4);
    if (dds.blocks) {
      decode_blocks(dds.level, block_bytes(*dds.blocks), image,
                    [&](Bytes block) { return decode_bc(*dds.blocks, block); });
      return {};
    }
    for (std::size_t at = 0; at < image.rgba.size(); at += 4)
      for (std::size_t c = 0; c < 4; ++c)
        image.rgba[at + c] = c == 3 && dds.opaque ? std::uint8_t{255} : dds.level[at + dds.order[c]];
    return {};
  } catch (const Fault& fault) {
    return fault.reason;
  }
}

}  // namespace sheaf
