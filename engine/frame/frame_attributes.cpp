// SPDX-License-Identifier: MIT
#include "frame/frame_attributes.hpp"

#include "settings/setting.hpp"

namespace sheaf {
namespace {

// World to the image's unit square, y down (see FrameAttributes).
glm::dmat4 world_to_ndc(const CameraView& camera, double aspect) {
  const glm::dmat4 to_camera = glm::inverse(camera.to_world);
  const double y = camera.orthographic ? camera.half_height : camera.tan_half_y, x = y * aspect;
  glm::dmat4 project(0);  // column-major
  project[0][0] = 0.5 / x;
  project[1][1] = -0.5 / y;
  if (camera.orthographic) {
    project[3] = glm::dvec4(0.5, 0.5, 0, 1);
    project[2][2] = -1;
  } else {
    project[2] = glm::dvec4(-0.5, -0.5, -1, -1);
  }
  return project * to_camera;
}

}  // namespace

FrameAttributes frame_attributes(const FrameInputs& inputs, const CameraView& camera, double aspect, double fps,
                                 const std::string& strategy) {
  FrameAttributes a;
  a.world_to_camera = glm::inverse(camera.to_world);
  a.world_to_ndc = world_to_ndc(camera, aspect);
  a.fps = fps;
  a.frame = inputs.frame;
  a.time_s = inputs.time_s;
  a.scene_sha256 = inputs.scene_sha256;
  a.settings_json = inputs.settings_json;
  a.strategy = strategy;
  a.version = inputs.version;
  return a;
}

}  // namespace sheaf
