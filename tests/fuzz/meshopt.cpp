// SPDX-License-Identifier: MIT
// The codecs of meshopt alone. Three bytes say how the rest is read: mode and filter, stride, and how many elements.
#include "scene/meshopt.hpp"

#include <array>
#include <vector>

#include "target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sheaf;
  if (size < 3) return 0;
  const std::span<const std::uint8_t> stream(data + 3, size - 3);
  const auto mode = static_cast<meshopt::Mode>(data[0] % 3);
  const auto filter = static_cast<meshopt::Filter>(data[0] / 3 % 5);
  static constexpr std::array<std::size_t, 5> filtered{0, 4, 8, 4, 8};
  std::size_t stride = data[1] % 2 == 0 ? 2 : 4, count = std::size_t{data[2]} * 3;
  if (mode == meshopt::Mode::attributes) {
    stride = (data[1] % 64 + std::size_t{1}) * 4;
    if (filter != meshopt::Filter::none) stride = data[1] % 2 == 0 ? 8 : filtered[static_cast<std::size_t>(filter)];
  }
  std::vector<std::uint8_t> out(count * stride);
  bool whole = false;
  if (mode == meshopt::Mode::triangles) whole = meshopt::decode_triangles(stream, stride, out);
  if (mode == meshopt::Mode::indices) whole = meshopt::decode_indices(stream, stride, out);
  if (mode == meshopt::Mode::attributes) {
    whole = meshopt::decode_attributes(stream, stride, out);
    meshopt::apply_filter(filter, stride, out);
  }
  if (whole) fuzz::require(stream.size() >= meshopt::least_bytes(mode, count, stride), "nothing is shorter than that");
  return 0;
}
