// SPDX-License-Identifier: MIT
// Shade: the light of the shadow rays that got through joins its pixel.
#pragma once

#include "device_data/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

/// Whose shadow rays the list holds.
struct ShadowParents {
  bool primary;             // the camera's rays, else reflections and refractions
  bool one_a_pixel;         // of each kind
  bool both_one_per_pixel;  // of both
};

class Shade {
 public:
  Shade(const Device& device, const Plan& plan, const Features& features, std::uint32_t lights, bool counted);
  void record(Recorder& recorder, const RayMemory& memory, const ShadowParents& parents) const;

 private:
  Kernel shade_;
  bool refractions_, by_parent_;
};

}  // namespace sheaf
