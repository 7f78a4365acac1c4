// SPDX-License-Identifier: MIT
#include "stages/shade.hpp"

#include <array>

namespace sheaf {

Shade::Shade(const Device& device, const Features& features, bool counted) {
  const std::array constants{SpecConstant{SPEC_TRANSLUCENT, features.translucent() || features.masked},
                             SpecConstant{SPEC_COUNTED, counted}};
  shade_ = Kernel(device, "shade", constants);
}

void Shade::record(Recorder& recorder, const RayMemory& memory, std::uint32_t sums) const {
  recorder.stage("shade");
  memory.shadow.bind(recorder);
  recorder.dispatch_indirect(shade_, sums, gpu::ARGS_RAYS);
}

}  // namespace sheaf
