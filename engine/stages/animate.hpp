// SPDX-License-Identifier: MIT
// Animate (algorithm 1): morphing and skinning, then world-space triangles, of what moved.
#pragma once

#include "device_data/device_scene.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Animate {
 public:
  Animate(const Device& device, const Plan& plan, const SceneLayout& layout);
  void record(Recorder& recorder, const DeviceScene& scene, const Motion& motion) const;

 private:
  Kernel vertices_, triangles_;
};

}  // namespace sheaf
