// SPDX-License-Identifier: MIT
// Reduce, spine, scatter: the three kernels of one scan (shaders/lists/scan.glsl), dispatched over blocks that the
// device counted.
#pragma once

#include <string>

#include "vulkan/kernel.hpp"
#include "vulkan/recorder.hpp"

namespace sheaf {

class Scan {
 public:
  Scan() = default;
  Scan(const Device& device, const std::string& stem) {
    // One subgroup of a CPU device (scan.glsl); its size divides SCAN_BLOCK.
    const SpecConstant group{SPEC_GROUP, device.limits().cpu ? device.limits().subgroup : gpu::SCAN_GROUP};
    reduce_ = Kernel(device, stem + "_reduce", {&group, 1});
    spine_ = Kernel(device, stem + "_spine", {&group, 1});
    scatter_ = Kernel(device, stem + "_scatter", {&group, 1});
  }

  /// `args`: the ARGS_… record with one workgroup per block. The spine always runs: it publishes the total, also of
  /// nothing.
  template <typename Push>
  void record(Recorder& recorder, const Push& push, std::uint32_t args) const {
    recorder.dispatch_indirect(reduce_, push, args);
    recorder.dispatch(spine_, push, 1);
    recorder.dispatch_indirect(scatter_, push, args);
  }

  /// `scatter_args`: where the spine decides whether there is room to scatter into.
  template <typename Push>
  void record(Recorder& recorder, const Push& push, std::uint32_t args, std::uint32_t scatter_args) const {
    recorder.dispatch_indirect(reduce_, push, args);
    recorder.dispatch(spine_, push, 1);
    recorder.dispatch_indirect(scatter_, push, scatter_args);
  }

  template <typename Push>
  void record_blocks(Recorder& recorder, const Push& push, std::uint64_t blocks) const {
    recorder.dispatch(reduce_, push, blocks);
    recorder.dispatch(spine_, push, 1);
    recorder.dispatch(scatter_, push, blocks);
  }

 private:
  Kernel reduce_, spine_, scatter_;
};

}  // namespace sheaf
