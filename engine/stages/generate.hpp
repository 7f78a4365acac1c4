// SPDX-License-Identifier: MIT
// Generate (algorithm 3): the camera's rays, and from the hits of one generation the rays of the next.
#pragma once

#include "frame/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Generate {
 public:
  Generate(const Device& device, const Plan& plan, const Features& features, bool counted);

  /// The camera's rays into memory.reflection[1].
  void primary(Recorder& recorder, const RayMemory& memory, std::uint32_t rays) const;
  /// Shades the hits of the lists `from` (0 or 1; the camera's where `is_primary`) and makes the rays that follow.
  void secondary(Recorder& recorder, const RayMemory& memory, std::uint32_t from, bool is_primary, bool last) const;

 private:
  const Plan& plan_;
  Kernel primary_, begin_, generate_;
};

}  // namespace sheaf
