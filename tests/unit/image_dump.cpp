// SPDX-License-Identifier: MIT
// image_dump FILE: the texels of a KTX2 or DDS file, RGBA of 8 bits, row by row.
#include <cstdio>
#include <fstream>
#include <iterator>

#include "scene/image_codec.hpp"

int main(int argc, char** argv) {
  std::ifstream in(argc > 1 ? argv[1] : "", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::span<const std::uint8_t> file(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const bool is_dds = text.starts_with("DDS ");
  const sheaf::ImageHead head = is_dds ? sheaf::read_dds_head(file) : sheaf::read_ktx2_head(file);
  sheaf::Image image;
  image.width = head.width;
  image.height = head.height;
  const std::string fault = !head.fault.empty() ? head.fault
                            : is_dds            ? sheaf::decode_dds(file, image)
                                                : sheaf::decode_ktx2(file, image);
  if (!fault.empty()) return std::fprintf(stderr, "%s\n", fault.c_str()), 3;
  return std::fwrite(image.rgba.data(), 1, image.rgba.size(), stdout) == image.rgba.size() ? 0 : 1;
}
