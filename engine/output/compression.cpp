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

// ffmpeg (5.1 to 7.1, libavcodec/exr.c) takes DWA's blocks for those of B, G, R and A, whatever other channels there
// are.
std::string compression_warning(Compression compression, const LayerSet& layers) {
  if (compression != Compression::dwaa || !(layers.any_surface() || layers.tests)) return {};
  return "--compression dwaa with --aov: ffmpeg reads DWAA of R, G, B and A alone, and will refuse these files; "
         "OpenEXR, OpenImageIO and what builds on them read them";
}

}  // namespace sheaf
