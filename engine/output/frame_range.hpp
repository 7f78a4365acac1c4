// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace sheaf {

inline constexpr std::size_t max_frames = 1'000'000;
inline constexpr std::int64_t max_frame_number =
    std::numeric_limits<std::int32_t>::max();  // EXR attributes hold an int

/// `--frames`: items separated by commas, each `N`, `A-B` or `A-B:STEP` (B included if a step lands on it). A number
/// may have a leading minus, so "-5--1" runs from -5 to -1. Order is kept and repeats are dropped. Throws Error{usage}
/// with the item and the reason, also for more than max_frames, repeats counted.
[[nodiscard]] std::vector<std::int64_t> parse_frames(const std::string& text);

}  // namespace sheaf
