// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "frame/settings.hpp"
#include "output/exr_writer.hpp"
#include "scene/camera_path.hpp"
#include "scene/scene.hpp"

namespace sheaf {

[[nodiscard]] nlohmann::ordered_json settings_json(const RenderSettings& settings);

[[nodiscard]] FrameAttributes frame_attributes(const Scene& scene, const RenderSettings& settings,
                                               const CameraView& camera, std::int64_t frame, double time_s, double fps,
                                               const std::string& strategy);

}  // namespace sheaf
