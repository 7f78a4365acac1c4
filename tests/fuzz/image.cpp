// SPDX-License-Identifier: MIT
// Decoders of images that are not stb's: the first byte says which.
#include <iterator>

#include "scene/image_codec.hpp"
#include "target.hpp"

namespace {

struct Codec {
  sheaf::ReadImageHead head;
  sheaf::DecodeImage decode;
};

constexpr Codec codecs[] = {
#ifdef SHEAF_HAS_WEBP
    {sheaf::read_webp_head, sheaf::decode_webp},
#else
    {},
#endif
    {sheaf::read_ktx2_head, sheaf::decode_ktx2},
    {sheaf::read_dds_head, sheaf::decode_dds},
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  if (size == 0 || data[0] >= std::size(codecs) || codecs[data[0]].head == nullptr) return 0;
  const std::span<const std::uint8_t> file(data + 1, size - 1);
  const ImageHead head = codecs[data[0]].head(file);
  if (!head.fault.empty() || head.width > 2048 || head.height > 2048) return 0;
  Image image;
  image.width = head.width;
  image.height = head.height;
  if (codecs[data[0]].decode(file, image).empty())
    fuzz::require(image.rgba.size() == std::size_t{head.width} * head.height * 4, "the image has its size");
  return 0;
}
