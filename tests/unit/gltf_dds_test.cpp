// SPDX-License-Identifier: MIT
// MSFT_texture_dds: blocks whose texels are worked out by hand. tests/render/test_render_dds.py holds all modes against
// another decoder.
#include "core/error.hpp"
#include "gltf_support.hpp"
#include "scene/bc_blocks.hpp"
#include "scene/image_codec.hpp"

namespace sheaf {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;
using Texel = std::array<std::uint8_t, 4>;

Bytes dds(std::uint32_t width, std::uint32_t height, const char* name, const Bytes& level, std::uint32_t number = 0) {
  Bytes out = {'D', 'D', 'S', ' '};
  const auto put = [&](std::uint32_t value) {
    for (int b = 0; b < 4; ++b) out.push_back(static_cast<std::uint8_t>(value >> 8 * b));
  };
  for (const std::uint32_t value : {124u, 0x1007u, height, width, 0u, 0u, 1u}) put(value);
  for (int i = 0; i < 11; ++i) put(0);
  put(32), put(name != nullptr ? 4 : 0x41);
  if (name != nullptr) out.insert(out.end(), name, name + 4);
  for (const std::uint32_t mask : {32u, 0xff0000u, 0xff00u, 0xffu, 0xff000000u}) put(name != nullptr ? 0 : mask);
  if (name == nullptr) out.insert(out.begin() + 84, 4, 0);
  for (const std::uint32_t caps : {0x1000u, 0u, 0u, 0u, 0u}) put(caps);
  if (number != 0)
    for (const std::uint32_t value : {number, 3u, 0u, 1u, 0u}) put(value);
  out.insert(out.end(), level.begin(), level.end());
  return out;
}

struct Decoded {
  Image image;
  std::string fault;
};
Decoded decode(const Bytes& file) {
  const ImageHead head = read_dds_head(file);
  Decoded out;
  out.image.width = head.width;
  out.image.height = head.height;
  out.fault = head.fault.empty() ? decode_dds(file, out.image) : head.fault;
  return out;
}

// Indices 0, 1, 2, 3 in the first row, then zeros. Red 31 of 31 and blue 31 of 31.
const Bytes colors = {0x00, 0xf8, 0x1f, 0x00, 0xe4, 0, 0, 0};

TEST(Dds, FourColorsOrThreeAndTransparency) {
  BlockTexels texels = decode_bc(BlockFormat::bc1, colors);
  EXPECT_EQ(texels[0], (Texel{255, 0, 0, 255}));
  EXPECT_EQ(texels[1], (Texel{0, 0, 255, 255}));
  EXPECT_EQ(texels[2], (Texel{170, 0, 85, 255}));
  EXPECT_EQ(texels[3], (Texel{85, 0, 170, 255}));
  const Bytes turned = {0x1f, 0x00, 0x00, 0xf8, 0xe4, 0, 0, 0};
  texels = decode_bc(BlockFormat::bc1, turned);
  EXPECT_EQ(texels[2], (Texel{128, 0, 128, 255}));
  EXPECT_EQ(texels[3], (Texel{0, 0, 0, 0}));
}

TEST(Dds, AlphaAndSingleChannelsAreRamps) {
  Bytes ramp = {210, 0, 0x88, 0xc6, 0xfa, 0, 0, 0};  // 0, 1, 2, 3, 4, 5, 6, 7 from the first texel on, then zeros
  BlockTexels texels = decode_bc(BlockFormat::bc4, ramp);
  const std::array<int, 8> seven{210, 0, 180, 150, 120, 90, 60, 30};
  for (std::size_t t = 0; t < 8; ++t) EXPECT_EQ(texels[t], (Texel{static_cast<std::uint8_t>(seven[t]), 0, 0, 255}));
  std::swap(ramp[0], ramp[1]);
  texels = decode_bc(BlockFormat::bc4, ramp);
  const std::array<int, 8> five{0, 210, 42, 84, 126, 168, 0, 255};
  for (std::size_t t = 0; t < 8; ++t) EXPECT_EQ(texels[t][0], five[t]);
  Bytes both = ramp;
  both.insert(both.end(), colors.begin(), colors.end());
  texels = decode_bc(BlockFormat::bc3, both);
  EXPECT_EQ(texels[2], (Texel{170, 0, 85, 42}));
  const Bytes nibbles = {0x10, 0x32, 0, 0, 0, 0, 0, 0xf0};
  both = nibbles;
  both.insert(both.end(), colors.begin(), colors.end());
  texels = decode_bc(BlockFormat::bc2, both);
  EXPECT_EQ(texels[3], (Texel{85, 0, 170, 51}));
  EXPECT_EQ(texels[15][3], 255);
}

TEST(Dds, Bc7OfOneSubset) {
  // Mode 6: ends of seven bits and a lowest one; both ends 0x7f with 1 and 0 with 0, the first index 0, the others 15.
  Bytes block(16);
  const auto set = [&](unsigned at, unsigned count, unsigned value) {
    for (unsigned b = 0; b < count; ++b)
      block[(at + b) / 8] |= static_cast<std::uint8_t>((value >> b & 1) << (at + b) % 8);
  };
  set(6, 1, 1);
  for (unsigned channel = 0; channel < 4; ++channel) set(7 + 14 * channel, 7, 0x7f);
  set(63, 1, 1);
  for (unsigned t = 1; t < 16; ++t) set(64 + 4 * t, 4, 15);
  const BlockTexels texels = decode_bc7(block);
  EXPECT_EQ(texels[0], (Texel{255, 255, 255, 255}));
  EXPECT_EQ(texels[1], (Texel{0, 0, 0, 0}));
  EXPECT_EQ(decode_bc7(Bytes(16))[5], (Texel{0, 0, 0, 0})) << "reserved";
}

TEST(Dds, BlocksAreCutAtTheEdgeAndPlainTexelsOrdered) {
  Bytes level = colors;
  level.insert(level.end(), colors.begin(), colors.end());
  const Decoded blocks = decode(dds(5, 1, "DXT1", level));
  ASSERT_EQ(blocks.fault, "");
  EXPECT_EQ(blocks.image.rgba.size(), 20u);
  EXPECT_EQ(blocks.image.rgba[16], 255) << "the second block's first texel";
  const Decoded numbered = decode(dds(5, 1, "DX10", level, 71));
  EXPECT_EQ(numbered.image.rgba, blocks.image.rgba);
  const Decoded plain = decode(dds(2, 1, nullptr, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(plain.fault, "");
  EXPECT_EQ(plain.image.rgba, (Bytes{3, 2, 1, 4, 7, 6, 5, 8}));
}

TEST(Dds, WhatCannotBeReadIsNamed) {
  EXPECT_EQ(decode(dds(4, 4, "DXT5", Bytes(15))).fault, "is a DDS file that is cut short");
  EXPECT_EQ(decode(dds(0, 4, "DXT5", Bytes(16))).fault, "is a DDS file that does not hold a two-dimensional image");
  EXPECT_EQ(decode(dds(65536, 65536, "DXT5", Bytes(16))).fault, "is a DDS file that is cut short");
  EXPECT_EQ(decode(dds(4, 4, "BC4S", Bytes(16))).fault,
            "is a DDS file of a format that is not supported: BC1 to BC5 and BC7 are");
  EXPECT_EQ(decode(dds(4, 4, "DX10", Bytes(16), 95)).fault,
            "is a DDS file of the DXGI format 95, which is not supported");
  const Bytes whole = dds(4, 4, "DX10", Bytes(16), 98);
  for (std::size_t size = 4; size < whole.size(); ++size)
    EXPECT_EQ(decode(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))).fault,
              "is a DDS file that is cut short");
}

TEST(Dds, IsReadThroughItsExtension) {
  GltfBuilder b = whole_document();
  const int image = b.add("images", {{"bufferView", b.view(dds(4, 4, "DXT1", colors))}});
  b.add("textures", {{"extensions", {{"MSFT_texture_dds", {{"source", image}}}}}});
  b.doc["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.doc["meshes"][0]["primitives"][0]["material"] = 0;
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"MSFT_texture_dds"};
  const Scene scene = load(b);
  EXPECT_EQ(scene.images.at(0).rgba.at(8), 170);
}

}  // namespace
}  // namespace sheaf
