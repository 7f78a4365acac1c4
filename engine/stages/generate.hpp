// SPDX-License-Identifier: MIT
// Generate (algorithm 3): the camera's rays, and from the hits of one generation the rays of the next.
#pragma once

#include "device_data/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Generate {
 public:
  Generate(const Device& device, const Plan& plan, const Features& features, const RenderSettings& settings);

  /// The camera's rays into memory.reflection[1].
  void primary(Recorder& recorder, const RayMemory& memory, std::uint32_t rays) const;
  struct Parents {
    std::uint32_t from;  // lists 0 or 1; unused where they are the camera's rays
    bool primary;
    bool direct;         // the camera's rays were rasterised and not written: `primary` is left out
    std::uint32_t sums;  // gpu::SUMS_…: what the parents of one list are to their pixels
  };
  /// Shades the parents' hits and makes the rays that follow.
  void secondary(Recorder& recorder, const RayMemory& memory, const Parents& parents) const;

 private:
  const Plan& plan_;
  Kernel primary_, begin_, generate_;
};

}  // namespace sheaf
