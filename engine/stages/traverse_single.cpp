// SPDX-License-Identifier: MIT
#include "stages/traverse_single.hpp"

#include <array>

#include "interface/push/trace.h"

namespace sheaf {

SingleKernels::SingleKernels(const TraceContext& c, bool incoherent) {
  auto make = [&](bool any_hit) {
    auto constants = candidate_constants(c, any_hit);
    constants.push_back({SPEC_INCOHERENT, incoherent});
    if (incoherent) constants.push_back({SPEC_GROUP, c.device.limits().bundle});
    const bool packets = incoherent && c.device.limits().cpu;
    if (packets) constants.push_back({SPEC_LANES, c.device.limits().subgroup});
    return Kernel(c.device, packets ? "traverse_packets" : "traverse_single", constants);
  };
  nearest = make(false);
  if (c.plan.shadows) any = make(true);
}

void TraverseSingle::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  recorder.stage("traverse");
  list.bind(recorder);
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? kernels_.any : kernels_.nearest,
                             gpu::TraverseSinglePush{kind, 0, 0}, gpu::ARGS_RAYS);
}

}  // namespace sheaf
