// SPDX-License-Identifier: MIT
// Resolve: from fixed-point sums to the mean of a pixel's samples.
#pragma once

#include "frame/ray_lists.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Resolve {
 public:
  explicit Resolve(const Device& device) : resolve_(device, "resolve") {}
  void record(Recorder& recorder, const RayMemory& memory, std::uint32_t pixels, std::uint32_t samples) const {
    recorder.stage("resolve");
    recorder.bind(ROLE_OUTPUT, memory.output);
    const float inverse = 1.0F / static_cast<float>(samples);
    recorder.dispatch(resolve_, inverse, (std::uint64_t{pixels} * 4 + gpu::GROUP - 1) / gpu::GROUP);
    recorder.copy(memory.output, memory.readback, std::uint64_t{pixels} * 16);
  }

 private:
  Kernel resolve_;
};

}  // namespace sheaf
