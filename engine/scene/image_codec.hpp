// SPDX-License-Identifier: MIT
// Decoders of images other than PNG and JPEG: the size first, then the texels, as 8-bit RGBA. Each returns why the file
// cannot be read; what is empty says that it can.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "scene/scene.hpp"

namespace sheaf {

struct ImageHead {
  std::uint32_t width = 0, height = 0;
  std::string fault;
};

/// Takes no memory that depends on what the file says.
using ReadImageHead = ImageHead (*)(std::span<const std::uint8_t> file);
/// `image` has the head's size.
using DecodeImage = std::string (*)(std::span<const std::uint8_t> file, Image& image);

ImageHead read_webp_head(std::span<const std::uint8_t> file);
std::string decode_webp(std::span<const std::uint8_t> file, Image& image);

ImageHead read_dds_head(std::span<const std::uint8_t> file);
std::string decode_dds(std::span<const std::uint8_t> file, Image& image);

ImageHead read_ktx2_head(std::span<const std::uint8_t> file);
std::string decode_ktx2(std::span<const std::uint8_t> file, Image& image);

}  // namespace sheaf
