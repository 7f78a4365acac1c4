// SPDX-License-Identifier: MIT
// `--strategy auto`: the fastest for this scene and device, found by rendering the first frame small with each
// candidate.
#pragma once

#include <string>

#include "frame/renderer.hpp"

namespace sheaf {

struct Choice {
  Strategy strategy = Strategy::bvh;
  std::string because;
};

/// The scene needs its object hierarchy.
[[nodiscard]] Choice choose_strategy(const Device& device, const std::shared_ptr<DeviceScene>& scene,
                                     const Features& features, const RenderSettings& settings,
                                     const FrameRequest& first);

}  // namespace sheaf
