// SPDX-License-Identifier: MIT
// Strategy `reference`: frames from the double-precision renderer, for error.
#pragma once

#include <memory>

#include "frame/frame_source.hpp"

namespace sheaf {

[[nodiscard]] std::unique_ptr<FrameSource> make_reference_frames(const Scene& scene, const RenderSettings& settings);

}  // namespace sheaf
