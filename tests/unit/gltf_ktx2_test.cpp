// SPDX-License-Identifier: MIT
// KHR_texture_basisu: KTX 2.0 files that the test puts together, and what an encoder of Basis Universal made of
// pictures of our own. tests/render/test_render_basis.py holds the decoders against another one.
#include <fstream>
#include <iterator>

#include "core/error.hpp"
#include "core/sha256.hpp"
#include "gltf_support.hpp"
#include "scene/image_codec.hpp"

namespace sheaf {
namespace {

using namespace test;
using Bytes = std::vector<std::uint8_t>;

enum : std::uint32_t { plain_scheme = 0, zlib_scheme = 3 };
enum : std::uint32_t { R8 = 9, RGB8 = 23, RGBA8 = 37 };

struct Ktx2File {
  std::uint32_t format = RGBA8, width = 3, height = 2, layers = 0, faces = 1, levels = 1, scheme = plain_scheme;
  std::uint8_t color_model = 1;  // RGBSDA; 166: UASTC
  Bytes level;
  std::uint64_t unpacked = 0;

  [[nodiscard]] Bytes bytes() const {
    Bytes out = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    const auto put = [&](std::uint64_t value, int size) {
      for (int b = 0; b < size; ++b) out.push_back(static_cast<std::uint8_t>(value >> 8 * b));
    };
    constexpr std::uint64_t format_at = 104, format_size = 44, level_at = format_at + format_size;
    for (const std::uint32_t value : {format, 1u, width, height, 0u, layers, faces, levels, scheme}) put(value, 4);
    put(format_at, 4), put(format_size, 4), put(0, 4), put(0, 4), put(0, 8), put(0, 8);
    put(level_at, 8), put(level.size(), 8), put(unpacked != 0 ? unpacked : level.size(), 8);
    put(format_size, 4), put(0, 4), put(0x00280002, 4);
    put(color_model, 1), put(1, 1), put(1, 1), put(0, 29);
    out.insert(out.end(), level.begin(), level.end());
    return out;
  }
};

Bytes counted(std::size_t size) {
  Bytes out;
  for (std::size_t i = 0; i < size; ++i) out.push_back(static_cast<std::uint8_t>(7 * i + 1));
  return out;
}

// What is decoded, or the fault as text.
struct Decoded {
  Image image;
  std::string fault;
};
Decoded decode(const Bytes& file) {
  const ImageHead head = read_ktx2_head(file);
  Decoded out;
  out.image.width = head.width;
  out.image.height = head.height;
  out.fault = head.fault.empty() ? decode_ktx2(file, out.image) : head.fault;
  return out;
}

TEST(Ktx2, PlainTexelsAreExact) {
  for (const auto& [format, channels] : {std::pair{RGBA8, 4u}, {RGB8, 3u}, {R8, 1u}}) {
    Ktx2File file;
    file.format = format;
    file.level = counted(6 * channels);
    const Decoded decoded = decode(file.bytes());
    ASSERT_EQ(decoded.fault, "");
    for (std::size_t t = 0; t < 6; ++t)
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_EQ(decoded.image.rgba[4 * t + c], c < channels ? file.level[channels * t + c] : c == 3 ? 255 : 0);
  }
}

// One block that is stored as it is.
Bytes zlib_stored(const Bytes& data) {
  const auto size = static_cast<std::uint8_t>(data.size());
  Bytes out = {0x78, 0x01, 1, size, 0, static_cast<std::uint8_t>(~size), 0xff};
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : data) {
    out.push_back(byte);
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  for (const std::uint32_t half : {b, a})
    for (const int shift : {8, 0}) out.push_back(static_cast<std::uint8_t>(half >> shift));
  return out;
}

TEST(Ktx2, ZlibIsUnpackedToTheSizeThatIsSaid) {
  const Bytes texels = counted(24);
  Ktx2File file;
  file.scheme = zlib_scheme;
  file.unpacked = 24;
  file.level = zlib_stored(texels);
  EXPECT_EQ(decode(file.bytes()).image.rgba, texels);
  file.level[9] ^= 0x55;
  EXPECT_EQ(decode(file.bytes()).fault, "cannot be decoded: its compressed level is damaged");
  file.unpacked = std::uint64_t{1} << 40;
  EXPECT_EQ(decode(file.bytes()).fault, "is a KTX2 file whose finest level has 1099511627776 bytes, not 24");
}

TEST(Ktx2, WhatIsNotOneFlatImageIsNamed) {
  const auto fault = [](auto change) {
    Ktx2File file;
    file.level = counted(24);
    change(file);
    return decode(file.bytes()).fault;
  };
  EXPECT_EQ(fault([](Ktx2File&) {}), "");
  EXPECT_EQ(fault([](Ktx2File& f) { f.faces = 6; }), "is a KTX2 file that does not hold one two-dimensional image");
  EXPECT_EQ(fault([](Ktx2File& f) { f.layers = 2; }), "is a KTX2 file that does not hold one two-dimensional image");
  EXPECT_EQ(fault([](Ktx2File& f) { f.width = 0; }), "is a KTX2 file that does not hold one two-dimensional image");
  EXPECT_EQ(fault([](Ktx2File& f) { f.levels = 4000000000; }), "is a KTX2 file with 4000000000 levels");
  EXPECT_EQ(fault([](Ktx2File& f) { f.format = 97; }),
            "is a KTX2 file of the Vulkan format 97, which is not supported");
  EXPECT_EQ(fault([](Ktx2File& f) { f.format = 0; }), "is a KTX2 file of the colour model 1, which is not supported");
  EXPECT_EQ(fault([](Ktx2File& f) { f.scheme = 4; }),
            "is a KTX2 file whose supercompression scheme 4 is not supported");
  EXPECT_EQ(fault([](Ktx2File& f) { f.width = 60000; }), "is a KTX2 file whose finest level has 24 bytes, not 480000");
}

TEST(Ktx2, BlocksOfUastcAreCutAtTheEdge) {
  // Mode 8 is one colour for sixteen texels; of two blocks the second keeps one column.
  Ktx2File file;
  file.format = 0;
  file.color_model = 166;
  file.width = 5;
  file.height = 3;
  const auto solid = [](std::uint64_t r, std::uint64_t g, std::uint64_t b, std::uint64_t a) {
    const std::uint64_t bits = 0x17 | r << 5 | g << 13 | b << 21 | a << 29;
    Bytes block(16);
    for (std::size_t i = 0; i < 8; ++i) block[i] = static_cast<std::uint8_t>(bits >> 8 * i);
    return block;
  };
  file.level = solid(1, 2, 3, 4);
  const Bytes second = solid(250, 150, 50, 255);
  file.level.insert(file.level.end(), second.begin(), second.end());
  const Decoded decoded = decode(file.bytes());
  ASSERT_EQ(decoded.fault, "");
  ASSERT_EQ(decoded.image.rgba.size(), 60u);
  for (std::size_t y = 0; y < 3; ++y) {
    EXPECT_EQ(decoded.image.rgba[(y * 5 + 3) * 4 + 2], 3);
    EXPECT_EQ(decoded.image.rgba[(y * 5 + 4) * 4 + 1], 150);
  }
  file.level.assign(32, 0x45);  // a reserved mode
  EXPECT_EQ(decode(file.bytes()).image.rgba[1], 0);
  EXPECT_EQ(decode(file.bytes()).image.rgba[2], 255) << "magenta";
}

Bytes seed(const char* name) {
  std::ifstream in(std::string(SHEAF_SOURCE_DIR "/tests/fuzz/corpus/image/") + name, std::ios::binary);
  Bytes bytes{std::istreambuf_iterator<char>(in), {}};
  if (!bytes.empty()) bytes.erase(bytes.begin());  // says which decoder the fuzzer is to call
  return bytes;
}

TEST(Ktx2, WhatAnEncoderWroteIsWhatAnotherDecoderReads) {
  for (const auto& [name, sum] :
       {std::pair{"ktx2_etc1s", "cbe299fd5876727f2f30bbdbb12141d6aaaa77560e0b93395cc02439bb5e2f9b"},
        std::pair{"ktx2_etc1s_alpha", "e0d8de23f61506e172e9c4556e8118fd0b3822266b6c535fe1ce64ba981971e9"},
        std::pair{"ktx2_uastc", "23704652dc3fca781abf957a4e9a86454a9b166ac4a02eb736e30d92695861bf"},
        std::pair{"ktx2_uastc_ramp", "79aef044096d93366bb75953102dcd26c26b695894ef8aef19dc2d1b459575a2"}}) {
    const Bytes file = seed(name);
    const Decoded decoded = decode(file);
    ASSERT_EQ(decoded.fault, "") << name;
    EXPECT_EQ(sha256_of(decoded.image.rgba), sum) << name;
    for (std::size_t size = 0; size < file.size(); ++size)
      (void)decode(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)));
  }
}

TEST(Ktx2, IsReadThroughItsExtension) {
  Ktx2File file;
  file.level = counted(24);
  GltfBuilder b = whole_document();
  const int image = b.add("images", {{"bufferView", b.view(file.bytes())}, {"mimeType", "image/ktx2"}});
  b.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", image}}}}}});
  b.doc["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.doc["meshes"][0]["primitives"][0]["material"] = 0;
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_texture_basisu"};
  const Scene scene = load(b);
  EXPECT_EQ(scene.images.at(0).rgba, file.level);
  LoadLimits limits;
  limits.image_side = 2;
  EXPECT_THROW((void)load(b, {}, limits), Error);
}

}  // namespace
}  // namespace sheaf
