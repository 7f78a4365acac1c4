// SPDX-License-Identifier: MIT
// Rays' hierarchy (R 4.3): all levels over a list whose number of rays the host knows.
#pragma once

#include "stages/tracer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

struct HierarchyLevel {
  std::uint32_t nodes = 0;
  std::uint32_t first_word = 0;  // in the ray-node buffer; level 0 are the rays themselves
};

/// Levels of the hierarchy over `rays` rays, 0 (the rays) to the root.
[[nodiscard]] std::vector<HierarchyLevel> hierarchy_levels(std::uint32_t rays);

class RaysHierarchy {
 public:
  explicit RaysHierarchy(const Device& device) : level_(device, "rays_hierarchy") {}
  void record(Recorder& recorder, const RayMemory& memory, std::uint32_t kind,
              const std::vector<HierarchyLevel>& levels) const;

 private:
  Kernel level_;
};

}  // namespace sheaf
