// SPDX-License-Identifier: MIT
// Whether a frame that is there is the one that would be rendered now: what decided it stands in its attributes.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace sheaf {

/// Everything that decides a frame's file: the same inputs give the same bytes, but for the attribute sheaf:strategy.
struct FrameInputs {
  std::string version, scene_sha256;
  std::string settings_json;  // camera, animation, layers and compression among them
  std::int64_t frame = 0;
  double time_s = 0;
};

/// As the file's attributes tell; nothing where it does not open or lacks one.
[[nodiscard]] std::optional<FrameInputs> read_frame_inputs(const std::string& path) noexcept;

/// What is different, in words ("another scene", "other settings: spp, camera"); empty where nothing is.
[[nodiscard]] std::string difference(const FrameInputs& there, const FrameInputs& wanted);

[[nodiscard]] nlohmann::ordered_json to_json(const FrameInputs& inputs);

}  // namespace sheaf
