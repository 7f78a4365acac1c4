// SPDX-License-Identifier: MIT
#include <webp/decode.h>

#include "scene/image_codec.hpp"

namespace sheaf {

ImageHead read_webp_head(std::span<const std::uint8_t> file) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(file.data(), file.size(), &features) != VP8_STATUS_OK || features.width <= 0 ||
      features.height <= 0)
    return {0, 0, "is not a valid WebP file"};
  if (features.has_animation != 0) return {0, 0, "is a WebP animation, not an image"};
  return {static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height), {}};
}

std::string decode_webp(std::span<const std::uint8_t> file, Image& image) {
  const std::size_t row = std::size_t{image.width} * 4;
  image.rgba.resize(row * image.height);
  const std::uint8_t* const done =
      WebPDecodeRGBAInto(file.data(), file.size(), image.rgba.data(), image.rgba.size(), static_cast<int>(row));
  return done == nullptr ? "cannot be decoded: it is damaged" : "";
}

}  // namespace sheaf
