// SPDX-License-Identifier: MIT
// Shade: the light of the shadow rays that got through joins its pixel.
#pragma once

#include "frame/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Shade {
 public:
  Shade(const Device& device, const Features& features, bool counted);
  /// `sums`: gpu::SUMS_…, what the list's rays are to their pixels.
  void record(Recorder& recorder, const RayMemory& memory, std::uint32_t sums) const;

 private:
  Kernel shade_;
};

}  // namespace sheaf
