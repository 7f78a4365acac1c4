// SPDX-License-Identifier: MIT
#pragma once

#include "output/exr_writer.hpp"
#include "scene/camera_path.hpp"
#include "scene/scene.hpp"
#include "settings/render_settings.hpp"

namespace sheaf {

[[nodiscard]] FrameAttributes frame_attributes(const Scene& scene, const RenderOptions& options,
                                               const CameraView& camera, std::int64_t frame, double time_s, double fps,
                                               const std::string& strategy);

}  // namespace sheaf
