// SPDX-License-Identifier: MIT
// Previews: the frame over black, tone mapped, as an 8-bit sRGB PNG. For looking at, not for measuring.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace sheaf {

/// Linear Rec.709, exposure 1, to display-linear [0,1]: the Khronos PBR Neutral curve, which leaves colours below 0.76
/// almost as they are and rolls brighter ones off towards white. Negative and NaN components count as 0.
[[nodiscard]] glm::vec3 tone_map(glm::vec3 linear);

/// `rgba`: 4 floats per pixel, linear, premultiplied (so that over black is RGB itself), row 0 at the top.
/// Throws Error{usage} if the size does not fit.
[[nodiscard]] std::vector<std::byte> encode_preview_png(std::span<const float> rgba, std::uint32_t width,
                                                        std::uint32_t height);

/// Under its name only when whole; Error{io} otherwise.
void write_preview(const std::string& path, std::span<const float> rgba, std::uint32_t width, std::uint32_t height);

}  // namespace sheaf
