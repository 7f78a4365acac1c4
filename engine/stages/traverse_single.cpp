// SPDX-License-Identifier: MIT
#include "stages/traverse_single.hpp"

#include <array>

namespace sheaf {

SingleKernels::SingleKernels(const TraceContext& c, bool loose) {
  const bool translucent = c.features.translucent() || c.features.masked;
  auto make = [&](bool any_hit) {
    const std::array constants{SpecConstant{1, any_hit},
                               SpecConstant{2, c.features.masked},
                               SpecConstant{3, any_hit && translucent},
                               SpecConstant{6, c.counted},
                               SpecConstant{7, c.settings.layers.tests},
                               SpecConstant{8, loose},
                               SpecConstant{9, c.features.textured}};
    return Kernel(c.device, "traverse_single", constants);
  };
  nearest = make(false);
  if (c.plan.shadows) any = make(true);
}

void TraverseSingle::trace(Recorder& recorder, const RayList& list, std::uint32_t kind, std::uint32_t) {
  recorder.stage("traverse");
  list.bind(recorder);
  recorder.dispatch_indirect(kind == gpu::KIND_SHADOW ? kernels_.any : kernels_.nearest, kind, gpu::ARGS_RAYS);
}

}  // namespace sheaf
