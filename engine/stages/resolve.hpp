// SPDX-License-Identifier: MIT
// Resolve: from fixed-point sums to the mean of a pixel's samples.
#pragma once

#include "device_data/ray_lists.hpp"
#include "interface/push/shade.h"
#include "vulkan/kernel.hpp"

namespace sheaf {

class Resolve {
 public:
  explicit Resolve(const Device& device) : resolve_(device, "resolve") {}
  void record(Recorder& recorder, const RayMemory& memory, std::uint32_t pixels, std::uint32_t samples) const {
    recorder.stage("resolve");
    const gpu::ResolvePush push{(memory.output ? memory.output : memory.readback).address_words(),
                                1.0F / static_cast<float>(samples)};
    recorder.dispatch(resolve_, push, (std::uint64_t{pixels} + gpu::GROUP - 1) / gpu::GROUP);
    if (memory.output) recorder.copy(memory.output, memory.readback, std::uint64_t{pixels} * 16);
  }

 private:
  Kernel resolve_;
};

}  // namespace sheaf
