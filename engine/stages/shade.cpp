// SPDX-License-Identifier: MIT
#include "stages/shade.hpp"

#include <array>

#include "interface/push/shade.h"

namespace sheaf {

// By turns on llvmpipe: parent by parent two lights' rays take 0.74 to 0.83 of the time, one light's 1.1.
Shade::Shade(const Device& device, const Plan& plan, const Features& features, std::uint32_t lights, bool counted)
    : refractions_(plan.refractions), by_parent_(lights > 1) {
  const std::array constants{SpecConstant{SPEC_TRANSLUCENT, features.translucent() || features.masked},
                             SpecConstant{SPEC_COUNTED, counted}, SpecConstant{SPEC_BY_PARENT, by_parent_}};
  shade_ = Kernel(device, "shade", constants);
}

void Shade::record(Recorder& recorder, const RayMemory& memory, const ShadowParents& parents) const {
  recorder.stage("shade");
  memory.shadow.bind(recorder);
  gpu::ShadePush push{parents.primary ? gpu::KIND_PRIMARY : gpu::KIND_REFLECTION, gpu::SUMS_SHARED};
  if (!by_parent_) {
    if (parents.both_one_per_pixel) push.sums = gpu::SUMS_OWN;
    recorder.dispatch_indirect(shade_, push, gpu::ARGS_RAYS);
    return;
  }
  if (parents.one_a_pixel) push.sums = gpu::SUMS_OWN;
  recorder.dispatch_indirect(shade_, push, gpu::ARGS_PARENTS);
  if (parents.primary || !refractions_) return;
  push.kind = gpu::KIND_REFRACTION;
  recorder.dispatch_indirect(shade_, push, gpu::ARGS_PARENTS_REFRACTION);
}

}  // namespace sheaf
