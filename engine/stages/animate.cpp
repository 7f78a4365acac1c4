// SPDX-License-Identifier: MIT
#include "stages/animate.hpp"

#include <array>

#include "interface/push/animate.h"

namespace sheaf {

Animate::Animate(const Device& device, const Plan& plan, const SceneLayout& layout) {
  const std::array constants{SpecConstant{SPEC_TRANSFORM_ON_FETCH, plan.transform_on_fetch},
                             SpecConstant{SPEC_MIRRORED_SKINS, layout.mirrored_skins}};
  triangles_ = Kernel(device, "animate_triangles", constants);
  if (layout.deforms.empty()) return;
  const std::array deforming{SpecConstant{SPEC_FACE_TANGENTS, layout.face_tangents},
                             SpecConstant{SPEC_MORPHED_ATTRIBUTES, layout.morphed_attributes}};
  vertices_ = Kernel(device, "animate_vertices", deforming);
}

void Animate::record(Recorder& recorder, const DeviceScene& scene, const Motion& motion) const {
  if (motion.triangle_blocks == 0) return;
  recorder.stage("animate");
  if (motion.vertex_blocks > 0) {
    recorder.bind(ROLE_ANIMATE_BLOCKS, scene.vertex_work());
    recorder.dispatch(vertices_, gpu::AnimatePush{motion.vertex_blocks}, motion.vertex_blocks);
  }
  recorder.bind(ROLE_ANIMATE_BLOCKS, scene.triangle_work());
  recorder.dispatch(triangles_, gpu::AnimatePush{motion.triangle_blocks}, motion.triangle_blocks);
}

}  // namespace sheaf
