// SPDX-License-Identifier: MIT
// Surface layers (`--aov`): what the camera's rays of sample 0 saw first.
#pragma once

#include "device_data/device_scene.hpp"
#include "device_data/ray_lists.hpp"
#include "device_data/tile.hpp"
#include "output/exr_writer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Layers {
 public:
  Layers(const Device& device, const Plan& plan, const Features& features);
  void record(Recorder& recorder, const RayMemory& memory, std::uint32_t pixels) const;
  /// From the read-back buffer into the frame; positions become absolute, and a miss's depth `z_background`.
  static void store(const RayMemory& memory, const Tile& tile, const glm::dvec3& origin, float z_background,
                    FrameLayers& out);

 private:
  Kernel layers_;
};

/// Sizes the vectors of the layers asked for.
void allocate_layers(const LayerSet& wanted, FrameLayers& layers);

}  // namespace sheaf
