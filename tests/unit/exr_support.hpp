// SPDX-License-Identifier: MIT
// Small frames for tests of OpenEXR files.
#pragma once

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

}  // namespace sheaf::test
