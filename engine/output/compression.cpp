// SPDX-License-Identifier: MIT
#include "output/compression.hpp"

namespace sheaf {

std::string compression_conflict(Compression compression, const LayerSet& layers) {
  if (compression != Compression::dwaa) return {};
  const char* const data = layers.normal ? "N" : layers.position ? "P" : layers.uv ? "UV" : nullptr;
  if (data == nullptr) return {};
  return std::string("--compression dwaa: would store ") + data + ".Y of --aov " + data +
         " with loss, as if it were luminance; use zip or piz";
}

}  // namespace sheaf
