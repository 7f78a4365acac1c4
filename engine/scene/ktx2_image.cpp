// SPDX-License-Identifier: MIT
// KTX 2.0: the finest level of a two-dimensional image. Sizes are held against each other before anything is unpacked.
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "scene/basis_lz.hpp"
#include "scene/image_codec.hpp"
#include "scene/uastc.hpp"

#ifdef SHEAF_HAS_ZSTD
#include <zstd.h>
#endif

namespace sheaf {
namespace {

using Bytes = std::span<const std::uint8_t>;

struct Fault {
  std::string reason;
};

enum class Layout { bytes, etc1s, uastc };
enum Scheme : std::uint32_t { scheme_none = 0, scheme_basis = 1, scheme_zstd = 2, scheme_zlib = 3 };

std::uint64_t number(Bytes file, std::uint64_t at, unsigned size) {
  if (at > file.size() || size > file.size() - at) throw Fault{"is a KTX2 file that is cut short"};
  std::uint64_t value = 0;
  for (unsigned b = 0; b < size; ++b) value |= std::uint64_t{file[at + b]} << 8 * b;
  return value;
}
std::uint32_t word(Bytes file, std::uint64_t at) { return static_cast<std::uint32_t>(number(file, at, 4)); }

Bytes part(Bytes file, std::uint64_t offset, std::uint64_t length) {
  if (offset > file.size() || length > file.size() - offset) throw Fault{"is a KTX2 file that is cut short"};
  return file.subspan(offset, length);
}

struct Ktx2 {
  std::uint32_t width = 0, height = 0, scheme = 0;
  Layout layout = Layout::bytes;
  unsigned channels = 4;  // of `bytes`
  bool srgb = false;
  std::array<std::uint32_t, 2> channel_ids{};  // of the data format's samples
  std::size_t samples = 0;
  Bytes level, global;
  std::uint64_t unpacked = 0, images = 0;
};

// Vulkan's numbers of the plain formats of 8 bits, UNORM and SRGB.
unsigned channels_of(std::uint32_t format) {
  if (format == 9 || format == 15) return 1;
  if (format == 16 || format == 22) return 2;
  if (format == 23 || format == 29) return 3;
  if (format == 37 || format == 43) return 4;
  throw Fault{"is a KTX2 file of the Vulkan format " + std::to_string(format) + ", which is not supported"};
}

void read_format(Bytes file, std::uint32_t vulkan_format, Ktx2& out) {
  constexpr std::uint8_t etc1s = 163, uastc = 166, transfer_srgb = 2;
  constexpr std::size_t head = 28, sample_size = 16;
  const Bytes format = part(file, word(file, 48), word(file, 52));
  if (format.size() < head) throw Fault{"is a KTX2 file without a description of its format"};
  out.srgb = format[14] == transfer_srgb;
  out.samples = std::min((format.size() - head) / sample_size, out.channel_ids.size());
  for (std::size_t s = 0; s < out.samples; ++s) out.channel_ids[s] = format[head + s * sample_size + 3] & 15u;
  if (vulkan_format != 0)
    out.channels = channels_of(vulkan_format);
  else if (format[12] == etc1s)
    out.layout = Layout::etc1s;
  else if (format[12] == uastc)
    out.layout = Layout::uastc;
  else
    throw Fault{"is a KTX2 file of the colour model " + std::to_string(format[12]) + ", which is not supported"};
}

void check_scheme(const Ktx2& ktx) {
  if ((ktx.scheme == scheme_basis) != (ktx.layout == Layout::etc1s) || ktx.scheme > scheme_zlib)
    throw Fault{"is a KTX2 file whose supercompression scheme " + std::to_string(ktx.scheme) + " is not supported"};
#ifndef SHEAF_HAS_ZSTD
  if (ktx.scheme == scheme_zstd) throw Fault{"is compressed by Zstandard, and this build lacks libzstd"};
#endif
  if (ktx.layout == Layout::etc1s) return;
  const std::uint64_t expected = ktx.layout == Layout::uastc ? block_count(ktx.width, ktx.height) * 16
                                                             : std::uint64_t{ktx.width} * ktx.height * ktx.channels;
  if (ktx.unpacked != expected)
    throw Fault{"is a KTX2 file whose finest level has " + std::to_string(ktx.unpacked) + " bytes, not " +
                std::to_string(expected)};
  if (ktx.scheme == scheme_none && ktx.level.size() != expected) throw Fault{"is a KTX2 file that is cut short"};
}

Ktx2 parse(Bytes file) {
  Ktx2 out;
  out.width = word(file, 20);
  out.height = word(file, 24);
  const std::uint32_t depth = word(file, 28), layers = word(file, 32), faces = word(file, 36), levels = word(file, 40);
  out.scheme = word(file, 44);
  if (out.width == 0 || out.height == 0 || depth > 0 || layers > 0 || faces != 1)
    throw Fault{"is a KTX2 file that does not hold one two-dimensional image"};
  if (levels > 32) throw Fault{"is a KTX2 file with " + std::to_string(levels) + " levels"};
  out.images = std::max(levels, 1u);
  read_format(file, word(file, 12), out);
  out.global = part(file, number(file, 64, 8), number(file, 72, 8));
  out.level = part(file, number(file, 80, 8), number(file, 88, 8));
  out.unpacked = number(file, 96, 8);
  check_scheme(out);
  return out;
}

// The finest level without its supercompression; `storage` holds it where there was one.
Bytes unpacked_level(const Ktx2& ktx, std::vector<std::uint8_t>& storage) {
  if (ktx.scheme == scheme_none) return ktx.level;
  storage.resize(ktx.unpacked);
  std::size_t size = 0;
  if (ktx.scheme == scheme_zlib) {
    const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
        libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
    if (!decompressor || libdeflate_zlib_decompress(decompressor.get(), ktx.level.data(), ktx.level.size(),
                                                    storage.data(), storage.size(), &size) != LIBDEFLATE_SUCCESS)
      size = 0;
  }
#ifdef SHEAF_HAS_ZSTD
  if (ktx.scheme == scheme_zstd) {
    size = ZSTD_decompress(storage.data(), storage.size(), ktx.level.data(), ktx.level.size());
    if (ZSTD_isError(size) != 0) size = 0;
  }
#endif
  if (size != storage.size()) throw Fault{"cannot be decoded: its compressed level is damaged"};
  return storage;
}

void decode_bytes(Bytes level, unsigned channels, Image& image) {
  for (std::size_t t = 0; t < image.rgba.size() / 4; ++t)
    std::copy_n(&level[t * channels], channels, &image.rgba[t * 4]);
}

void decode_etc1s(const Ktx2& ktx, Image& image) {
  constexpr unsigned rgb = 7, green = 2, alpha = 8, channel_rrr = 3, channel_ggg = 4;
  const auto global = read_basis_global(ktx.global, ktx.images);
  if (!global) throw Fault{"cannot be decoded: its global data is damaged"};
  const BasisImage& first = global->first;
  const Bytes color = part(ktx.level, first.color_offset, first.color_length);
  const bool red_alone = ktx.samples > 0 && ktx.channel_ids[0] == channel_rrr;
  bool fine = decode_basis_slice(global->codebooks, color, rgb, red_alone ? 0 : 3, image);
  if (ktx.samples > 1 && first.alpha_length > 0) {
    const bool is_green = ktx.channel_ids[1] == channel_ggg;
    const Bytes second = part(ktx.level, first.alpha_offset, first.alpha_length);
    fine = fine && decode_basis_slice(global->codebooks, second, is_green ? green : alpha, 1, image);
  }
  if (!fine) throw Fault{"cannot be decoded: a slice is damaged"};
}

}  // namespace

ImageHead read_ktx2_head(Bytes file) {
  try {
    const Ktx2 ktx = parse(file);
    return {ktx.width, ktx.height, {}};
  } catch (const Fault& fault) {
    return {0, 0, fault.reason};
  }
}

std::string decode_ktx2(Bytes file, Image& image) {
  try {
    const Ktx2 ktx = parse(file);
    // Channels that the file lacks are 0, and alpha is 1.
    image.rgba.assign(std::size_t{image.width} * image.height * 4, 0);
    for (std::size_t at = 3; at < image.rgba.size(); at += 4) image.rgba[at] = 255;
    std::vector<std::uint8_t> storage;
    if (ktx.layout == Layout::etc1s) {
      decode_etc1s(ktx, image);
      return {};
    }
    const Bytes level = unpacked_level(ktx, storage);
    if (ktx.layout == Layout::uastc)
      decode_blocks(level, 16, image, [&](Bytes block) { return decode_uastc(block.first<16>(), ktx.srgb); });
    else
      decode_bytes(level, ktx.channels, image);
    return {};
  } catch (const Fault& fault) {
    return fault.reason;
  }
}

}  // namespace sheaf
