// SPDX-License-Identifier: MIT
#include "stages/intersect_brute.hpp"

#include <algorithm>
#include <array>

#include "interface/push/trace.h"

namespace sheaf {

IntersectBrute::IntersectBrute(const TraceContext& c) : triangles_(c.scene.triangles()) {
  auto make = [&](bool any_hit) { return Kernel(c.device, "intersect_brute", candidate_constants(c, any_hit)); };
  nearest_ = make(false);
  if (c.plan.shadows) any_ = make(true);
}

void IntersectBrute::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  constexpr std::uint32_t slice =
      8192;  // triangles a dispatch: seconds at most, even with a million rays on a CPU device
  recorder.stage("intersect");
  list.bind(recorder);
  std::uint32_t first = 0;
  do {
    const std::uint32_t last = std::min(first + slice, triangles_);
    const gpu::IntersectBrutePush push{kind, first, last};
    recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? any_ : nearest_, push, gpu::ARGS_RAYS);
    first = last;
  } while (first < triangles_);
}

}  // namespace sheaf
