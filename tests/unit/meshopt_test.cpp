// SPDX-License-Identifier: MIT
// The codecs of meshopt against streams of its encoder, filters against worked-out values, and bufferViews that use
// them.
#include "scene/meshopt.hpp"

#include <bit>
#include <cmath>

#include "core/error.hpp"
#include "gltf_support.hpp"
#include "meshopt_streams.hpp"

namespace sheaf {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(std::string_view text) {
  const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
  Bytes out;
  for (std::size_t i = 0; i < text.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(digit(text[i]) << 4 | digit(text[i + 1])));
  return out;
}

template <class T>
Bytes as_bytes(const std::vector<T>& values) {
  Bytes out(values.size() * sizeof(T));
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

// A slow ramp, two pairs of bytes, four bytes that go their own ways, and a word that mostly repeats.
Bytes mixed_elements(std::uint32_t count, std::uint32_t stride) {
  Bytes out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t squares = i * i, step = i >> 3;
    std::uint32_t bytes = 0;
    for (std::uint32_t b = 0; b < 4; ++b) bytes |= ((squares * (b + 1) + step) & 255) << 8 * b;
    const std::uint32_t words[] = {0x3f800000 + i * 4099, (i * 37 & 0xffff) | (65535 - i * 259) << 16, bytes,
                                   (i & 3) * 0x00180000 ^ (i % 7 == 3 ? 0x40001234 : 0x12345678)};
    for (std::uint32_t b = 0; b < stride; ++b) out.push_back(static_cast<std::uint8_t>(words[b / 4] >> b % 4 * 8));
  }
  return out;
}

Bytes alternating_floats(int count) {
  std::vector<float> out;
  for (int i = 0; i < count; ++i) out.push_back((i % 2 == 0 ? -1.0f : 1.0f) * (1 + static_cast<float>(i * 3 % 4) / 4));
  return as_bytes(out);
}

// A grid of six by six squares, then triangles whose vertices are far from each other.
std::vector<std::uint32_t> grid_indices() {
  std::vector<std::uint32_t> out;
  for (std::uint32_t y = 0; y < 6; ++y)
    for (std::uint32_t x = 0; x < 6; ++x)
      for (const std::uint32_t step : {0, 1, 7, 7, 1, 8}) out.push_back(y * 7 + x + step);
  for (const std::uint32_t index : {5, 900, 70000, 70000, 900, 3, 10, 20, 30}) out.push_back(index);
  return out;
}

const std::vector<std::uint32_t> index_list = {0, 1, 2, 7, 100000, 3, 100001, 4, 100002, 99999, 5, 6, 7, 0};

using Decode = bool (*)(meshopt::In, std::size_t, meshopt::Out);

// The stream gives `expected`; cut short anywhere, with a byte more, or of another codec it is damaged.
void expect_decoded(Decode decode, const char* hex, std::size_t stride, const Bytes& expected) {
  const Bytes stream = from_hex(hex);
  Bytes out(expected.size());
  ASSERT_TRUE(decode(stream, stride, out));
  EXPECT_EQ(out, expected);
  for (std::size_t size = 0; size < stream.size(); ++size) {
    const Bytes part(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(decode(part, stride, out)) << "cut to " << size << " bytes";
  }
  Bytes other = stream;
  other.insert(other.begin() + 1, 0);
  EXPECT_FALSE(decode(other, stride, out)) << "a byte more";
  other = stream;
  other[0] ^= 0x10;
  EXPECT_FALSE(decode(other, stride, out)) << "of another codec";
}

// The encoder turns triangles: they are compared with their smallest index first.
template <class Index>
void turn(meshopt::Out bytes) {
  for (std::size_t at = 0; at + 3 * sizeof(Index) <= bytes.size(); at += 3 * sizeof(Index)) {
    Index corners[3];
    std::memcpy(corners, &bytes[at], sizeof(corners));
    std::rotate(corners, std::min_element(corners, corners + 3), corners + 3);
    std::memcpy(&bytes[at], corners, sizeof(corners));
  }
}

template <class Index>
bool decode_turned(meshopt::In stream, std::size_t stride, meshopt::Out out) {
  if (!meshopt::decode_triangles(stream, stride, out)) return false;
  turn<Index>(out);
  return true;
}

template <class Index>
Bytes turned(const std::vector<std::uint32_t>& indices) {
  Bytes bytes = as_bytes(std::vector<Index>(indices.begin(), indices.end()));
  turn<Index>(bytes);
  return bytes;
}

TEST(Meshopt, AttributesOfBothVersionsAreExact) {
  for (const char* stream : {mixed_version_0, mixed_version_1, mixed_channels})
    expect_decoded(meshopt::decode_attributes, stream, 16, mixed_elements(40, 16));
  expect_decoded(meshopt::decode_attributes, two_blocks, 4, mixed_elements(272, 4));
  expect_decoded(meshopt::decode_attributes, one_element, 12, mixed_elements(1, 12));
  expect_decoded(meshopt::decode_attributes, rotated_words, 4, alternating_floats(40));
}

TEST(Meshopt, UnknownChannelModesAreDamage) {
  Bytes stream = from_hex(rotated_words), out(160);
  stream.back() = 0x33;
  EXPECT_FALSE(meshopt::decode_attributes(stream, 4, out));
  stream.back() = 0x10;  // bytes are not rotated
  EXPECT_FALSE(meshopt::decode_attributes(stream, 4, out));
}

TEST(Meshopt, IndicesAreExactInFourBytesAndWrapInTwo) {
  expect_decoded(decode_turned<std::uint32_t>, triangle_codes, 4, turned<std::uint32_t>(grid_indices()));
  expect_decoded(decode_turned<std::uint16_t>, triangle_codes, 2, turned<std::uint16_t>(grid_indices()));
  expect_decoded(meshopt::decode_indices, index_sequence, 4, as_bytes(index_list));
  expect_decoded(meshopt::decode_indices, index_sequence, 2,
                 as_bytes(std::vector<std::uint16_t>(index_list.begin(), index_list.end())));
}

TEST(Meshopt, TrianglesThatNameNoEarlierEdgeOrVertexAreDamage) {
  for (const int code : {0x00, 0x01, 0xf1}) {  // an edge, an edge, and by the table a vertex, none of which was before
    Bytes stream = {0xe1, static_cast<std::uint8_t>(code)}, out(12);
    stream.resize(18);
    stream[3] = 0x10;  // the table's second byte
    EXPECT_FALSE(meshopt::decode_triangles(stream, 4, out)) << code;
  }
}

template <class T>
std::vector<T> filtered(meshopt::Filter filter, std::size_t stride, const std::vector<T>& values) {
  Bytes bytes = as_bytes(values);
  meshopt::apply_filter(filter, stride, bytes);
  std::vector<T> out(values.size());
  std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

TEST(Meshopt, OctahedralVectorsAreUnitVectors) {
  using V16 = std::vector<std::int16_t>;
  using V8 = std::vector<std::int8_t>;
  // On the square's corner z = -1; (1/3, 1/3) has three equal components; K is told by the third number.
  EXPECT_EQ(filtered(meshopt::Filter::octahedral, 8, V16{511, 511, 511, -7}), (V16{0, 0, -32767, -7}));
  EXPECT_EQ(filtered(meshopt::Filter::octahedral, 8, V16{-127, 0, 127, 3}), (V16{-32767, 0, 0, 3}));
  EXPECT_EQ(filtered(meshopt::Filter::octahedral, 8, V16{1, 1, 3, 0}), (V16{18918, 18918, 18918, 0}));  // / √3
  EXPECT_EQ(filtered(meshopt::Filter::octahedral, 4, V8{0, -127, 127, 127}), (V8{0, -127, 0, 127}));
}

TEST(Meshopt, QuaternionsGetTheirLargestComponentBack) {
  using V = std::vector<std::int16_t>;
  const auto half = static_cast<std::int16_t>(std::lround(2047 * std::sqrt(0.5)));
  // The first number belongs to the component after the largest; 1/2 is stored as √2/2.
  EXPECT_EQ(filtered(meshopt::Filter::quaternion, 8, V{0, 0, 0, 2047}), (V{0, 0, 0, 32767}));
  EXPECT_EQ(filtered(meshopt::Filter::quaternion, 8, V{0, 0, 2047, 2045}), (V{23170, 23170, 0, 0}));
  const V mixed = filtered(meshopt::Filter::quaternion, 8, V{half, static_cast<std::int16_t>(-half), half, 2046});
  const double expected[] = {-0.5, 0.5, 0.5, 0.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(mixed[i] / 32767.0, expected[i], 1e-3) << i;
}

TEST(Meshopt, ExponentialsAreExact) {
  const auto coded = [](int exponent, int mantissa) {
    return static_cast<std::uint32_t>(exponent) << 24 | (static_cast<std::uint32_t>(mantissa) & 0xffffff);
  };
  const std::vector<std::uint32_t> out =
      filtered(meshopt::Filter::exponential, 12,
               std::vector<std::uint32_t>{coded(-10, 1025), coded(3, -7), coded(-100, (1 << 23) - 1)});
  EXPECT_EQ(std::bit_cast<float>(out[0]), 1025.0f / 1024);
  EXPECT_EQ(std::bit_cast<float>(out[1]), -56.0f);
  EXPECT_EQ(std::bit_cast<float>(out[2]), std::ldexp(8388607.0f, -100));
}

TEST(Meshopt, ColorsComeFromLumaAndChroma) {
  using V8 = std::vector<std::uint8_t>;
  using V16 = std::vector<std::uint16_t>;
  const auto minus = [](int value) { return static_cast<std::uint8_t>(-value); };
  // Red is y + co - cg, green y + cg, blue y - co - cg.
  EXPECT_EQ(filtered(meshopt::Filter::color, 4, V8{64, 127, minus(64), 255}), (V8{255, 0, 1, 255}));
  EXPECT_EQ(filtered(meshopt::Filter::color, 4, V8{10, 0, 0, 0x80 | 0x20}), (V8{10, 10, 10, 64}));
  // Five bits: 31 stands for 1, and the alpha of four bits gains the lowest one again.
  EXPECT_EQ(filtered(meshopt::Filter::color, 8, V16{31, 0, 0, 0x1f}), (V16{65535, 65535, 65535, 65535}));
  EXPECT_EQ(filtered(meshopt::Filter::color, 8, V16{0, 0, 0, 0x10}), (V16{0, 0, 0, 0}));
}

TEST(Meshopt, FiltersTakeAnyBytes) {
  for (const auto filter : {meshopt::Filter::octahedral, meshopt::Filter::quaternion, meshopt::Filter::exponential,
                            meshopt::Filter::color}) {
    Bytes bytes(8 * 4096);
    std::uint32_t state = 1;
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
    std::fill_n(bytes.begin(), 64, std::uint8_t{0});
    meshopt::apply_filter(filter, 8, bytes);
    if (filter == meshopt::Filter::octahedral || filter == meshopt::Filter::color)
      meshopt::apply_filter(filter, 4, bytes);
  }
}

// A triangle whose positions are the first elements of a stream, in a buffer that says no more of itself.
struct PackedTriangle {
  GltfBuilder builder;
  explicit PackedTriangle(const char* extension = "KHR_meshopt_compression") {
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const Bytes plain = as_bytes(positions);
    // Bytes as they are: header bits 3 for each of the twelve bytes of an element, then sixteen zigzag deltas.
    Bytes stream = {0xa0};
    for (std::size_t b = 0; b < 12; ++b) {
      stream.push_back(3);
      int before = plain[b];
      for (std::size_t i = 0; i < 16; ++i) {
        const int value = i < 3 ? plain[12 * i + b] : before, delta = static_cast<std::int8_t>(value - before);
        stream.push_back(static_cast<std::uint8_t>(delta < 0 ? -2 * delta - 1 : 2 * delta));
        before = value;
      }
    }
    stream.resize(stream.size() + 20);
    stream.insert(stream.end(), plain.begin(), plain.begin() + 12);
    const int view = builder.view(stream);
    json& object = builder.doc["bufferViews"][static_cast<std::size_t>(view)];
    json packed = object;
    packed.update({{"byteStride", 12}, {"count", 3}, {"mode", "ATTRIBUTES"}});
    object = {{"buffer", 1}, {"byteLength", 36}, {"extensions", {{extension, packed}}}};
    builder.node_with(
        {{"POSITION",
          builder.add("accessors", {{"bufferView", view}, {"componentType", FLOAT}, {"type", "VEC3"}, {"count", 3}})}});
    builder.embed();
    builder.doc["buffers"].push_back({{"byteLength", 36}, {"extensions", {{extension, {{"fallback", true}}}}}});
    builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {extension};
  }
  using json = nlohmann::json;
  json& view() { return builder.doc["bufferViews"][0]; }
  json& packed() { return view()["extensions"].front(); }

  void expect_refused(const std::string& text, const LoadLimits& limits = {}) {
    try {
      (void)load(builder, {}, limits);
      ADD_FAILURE() << "was read, and should say: " << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  }
};

TEST(MeshoptView, IsReadWithoutItsFallback) {
  for (const char* extension : {"KHR_meshopt_compression", "EXT_meshopt_compression"}) {
    PackedTriangle packed(extension);
    const Scene scene = load(packed.builder);
    expect_triangle(scene);
    EXPECT_TRUE(scene.warnings.empty()) << all_of(scene.warnings);
    EXPECT_TRUE(scene.extensions_ignored.empty());
  }
}

TEST(MeshoptView, SaysWhatIsWrongAndWhere) {
  const auto refused = [](const char* key, const nlohmann::json& value, const std::string& text) {
    PackedTriangle packed;
    packed.packed()[key] = value;
    packed.expect_refused(text);
  };
  refused("mode", "LINES", "bufferViews[0].KHR_meshopt_compression.mode: \"LINES\" is unknown");
  refused("filter", "SHARPEN", "filter: \"SHARPEN\" is unknown");
  refused("filter", "QUATERNION", "byteStride: 12 must be 8 for the filter QUATERNION");
  refused("filter", "COLOR", "byteStride: 12 must be 4 or 8");
  refused("byteStride", 6, "byteStride: 6 must be a multiple of 4");
  refused("mode", "TRIANGLES", "byteStride: 12 must be 2 or 4");
  refused("count", 9007199254740992, "bytes cannot hold 9007199254740992 elements");
  refused("byteOffset", 400, "are outside buffers[0]");
  refused("buffer", 2, "buffer: 2 is out of range");
  PackedTriangle damaged;
  damaged.packed()["byteLength"] = 230;
  damaged.expect_refused("bufferViews[0].KHR_meshopt_compression: the compressed data is damaged");
}

TEST(MeshoptView, WhatIsUnpackedIsLimited) {
  PackedTriangle packed;
  LoadLimits limits;
  limits.file_bytes = 1 << 20;
  auto stream = Bytes(20000);  // every control mode is 2: nothing is stored
  stream[0] = 0xa1;
  std::fill(stream.begin() + 1, stream.begin() + 19000, std::uint8_t{0xaa});
  packed.builder.doc["buffers"][0] = {{"byteLength", stream.size()},
                                      {"uri", "data:application/octet-stream;base64," + base64(stream)}};
  packed.packed().update({{"byteOffset", 0}, {"byteLength", stream.size()}, {"byteStride", 4}, {"count", 18000 * 256}});
  packed.expect_refused("what is compressed has more than 1048576 bytes", limits);
}

TEST(MeshoptView, OfFormOnlyIsAWarning) {
  PackedTriangle longer;
  longer.view()["byteLength"] = 40;
  const Scene scene = load(longer.builder);
  expect_triangle(scene);
  EXPECT_TRUE(warns(scene, "holds 36 bytes, the bufferView's byteLength says 40")) << all_of(scene.warnings);
  PackedTriangle both;
  both.view()["extensions"]["EXT_meshopt_compression"] = both.packed();
  EXPECT_TRUE(warns(load(both.builder), "EXT_meshopt_compression beside it is ignored"));
}

}  // namespace
}  // namespace sheaf
