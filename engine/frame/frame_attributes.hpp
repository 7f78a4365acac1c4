// SPDX-License-Identifier: MIT
#pragma once

#include "output/exr_writer.hpp"
#include "output/frame_inputs.hpp"
#include "scene/camera_path.hpp"
#include "scene/scene.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

[[nodiscard]] FrameAttributes frame_attributes(const FrameInputs& inputs, const CameraView& camera, double aspect,
                                               double fps, const std::string& strategy);

}  // namespace sheaf
