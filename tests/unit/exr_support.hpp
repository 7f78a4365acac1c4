// SPDX-License-Identifier: MIT
// Frames for tests of OpenEXR files.
#pragma once

#include <limits>
#include <random>

#include "output/exr_writer.hpp"
#include "output_support.hpp"

namespace sheaf::test {

inline FrameAttributes attributes() {
  FrameAttributes result;
  result.fps = 24;
  result.frame = 12;
  result.time_s = 0.5;
  result.scene_sha256 = "abc123";
  result.settings_json = R"({"size":[37,53]})";
  result.strategy = "hybrid";
  result.version = "0.1.0";
  return result;
}

/// One pixel.
inline FrameLayers tiny() {
  FrameLayers layers;
  layers.width = layers.height = 1;
  layers.rgba = {0.5f, 0.25f, 0.125f, 1};
  return layers;
}

inline std::vector<float> noise(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random()) / 4e9f * 20 - 10;
  return values;
}

/// Every layer, in a size that ends in the middle of every compression's chunk.
inline FrameLayers full(std::uint32_t width = 37, std::uint32_t height = 53) {
  const std::size_t pixels = std::size_t{width} * height;
  FrameLayers layers{width,
                     height,
                     noise(pixels * 4, 1),
                     noise(pixels, 2),
                     noise(pixels * 3, 3),
                     noise(pixels * 3, 4),
                     noise(pixels * 3, 5),
                     noise(pixels * 2, 6),
                     {},
                     {},
                     noise(pixels, 7)};
  for (std::size_t i = 0; i < pixels; ++i) {
    layers.object_id.push_back(static_cast<std::uint32_t>(i * 2654435761u));
    layers.material_id.push_back(static_cast<std::uint32_t>(~i));
  }
  layers.depth[5] = std::numeric_limits<float>::infinity();
  return layers;
}

}  // namespace sheaf::test
