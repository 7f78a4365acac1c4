// SPDX-License-Identifier: MIT
#include "stages/objects.hpp"

#include <array>

#include "interface/push/objects.h"

namespace sheaf {

Objects::Objects(const Device& device, const Plan& plan) {
  const std::array constants{SpecConstant{SPEC_TRANSFORM_ON_FETCH, plan.transform_on_fetch}};
  if (plan.object_hierarchy) refit_ = Kernel(device, "objects_refit", constants);
}

void Objects::record(Recorder& recorder, const DeviceScene& scene, const Motion& motion) const {
  if (motion.refit.empty()) return;
  recorder.stage("objects");
  recorder.bind(ROLE_REFIT_NODES, scene.refit_work());
  for (const auto& [first, count] : motion.refit) {
    const gpu::RefitPush push{first, count};
    recorder.dispatch(refit_, push, (std::uint64_t{count} + gpu::GROUP - 1) / gpu::GROUP);
  }
}

}  // namespace sheaf
