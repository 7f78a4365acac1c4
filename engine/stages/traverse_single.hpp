// SPDX-License-Identifier: MIT
// Strategy `bvh`: one ray per lane through the object hierarchy, in the order the rays come.
#pragma once

#include "stages/tracer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

/// Kernel variants of the single-ray walk, nearest and any hit. `incoherent`: those that `hybrid` uses for the rays of
/// its incoherent bundles, on a CPU device as packets of a subgroup (packet.glsl).
struct SingleKernels {
  SingleKernels() = default;
  SingleKernels(const TraceContext& context, bool incoherent);
  [[nodiscard]] bool made() const { return nearest.made() && any.made(); }
  [[nodiscard]] double making_ms() const { return nearest.making_ms() + any.making_ms(); }
  Kernel nearest, any;
};

class TraverseSingle final : public Tracer {
 public:
  explicit TraverseSingle(const TraceContext& context) : kernels_(context, false) {}
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;
  [[nodiscard]] bool made() const override { return kernels_.made(); }
  [[nodiscard]] double making_ms() const override { return kernels_.making_ms(); }

 private:
  SingleKernels kernels_;
};

}  // namespace sheaf
