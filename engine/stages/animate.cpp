// SPDX-License-Identifier: MIT
#include "stages/animate.hpp"

#include <array>

namespace sheaf {

Animate::Animate(const Device& device, const Plan& plan, bool deforms) {
  const std::array constants{SpecConstant{SPEC_POSED, plan.posed}};
  triangles_ = Kernel(device, "animate_triangles", constants);
  if (deforms) vertices_ = Kernel(device, "animate_vertices");
}

void Animate::record(Recorder& recorder, const DeviceScene& scene, const Motion& motion) const {
  if (motion.triangle_blocks == 0) return;
  recorder.stage("animate");
  if (motion.vertex_blocks > 0) {
    recorder.bind(ROLE_WORK, scene.vertex_work());
    recorder.dispatch(vertices_, motion.vertex_blocks, motion.vertex_blocks);
  }
  recorder.bind(ROLE_WORK, scene.triangle_work());
  recorder.dispatch(triangles_, motion.triangle_blocks, motion.triangle_blocks);
}

}  // namespace sheaf
