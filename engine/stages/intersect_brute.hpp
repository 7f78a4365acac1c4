// SPDX-License-Identifier: MIT
// Strategy `brute`: N × M tests (R 5.2).
#pragma once

#include "stages/tracer.hpp"
#include "vulkan/kernel.hpp"

namespace sheaf {

class IntersectBrute final : public Tracer {
 public:
  explicit IntersectBrute(const TraceContext& context);
  void trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t generation) override;

 private:
  std::uint32_t triangles_;
  Kernel nearest_, any_;
};

}  // namespace sheaf
