// SPDX-License-Identifier: MIT
// Objects (algorithm 7): the object hierarchy's boxes, refitted from the leaves where something moved.
#pragma once

#include "device_data/device_scene.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Objects {
 public:
  Objects(const Device& device, const Plan& plan);
  void record(Recorder& recorder, const DeviceScene& scene, const Motion& motion) const;

 private:
  Kernel refit_;
};

}  // namespace sheaf
