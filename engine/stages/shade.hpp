// SPDX-License-Identifier: MIT
// Shade: the light of the shadow rays that got through joins its pixel.
#pragma once

#include "frame/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Shade {
 public:
  Shade(const Device& device, const Features& features, bool counted);
  void record(Recorder& recorder, const RayMemory& memory) const;

 private:
  Kernel shade_;
};

}  // namespace sheaf
