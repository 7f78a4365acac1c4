// SPDX-License-Identifier: MIT
// How many samples, and what --quality stands for: the engine and the service read both alike.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sheaf {

struct SampleCount {
  std::uint32_t most = 1;       // a pixel; where they are not adaptive, of every pixel
  std::optional<double> error;  // adaptive: see AdaptivePixels
};

/// "N", or "adaptive:ERROR" with an optional ":MOST"; nothing where it is neither. Ranges are the caller's matter.
[[nodiscard]] std::optional<SampleCount> parse_sample_count(std::string_view text);
[[nodiscard]] std::string text_of(const SampleCount& samples);

struct Quality {
  const char* name;
  SampleCount samples;
  std::uint32_t depth;
  float cutoff;
};

/// On the front of error against time, as `sheaf-client report` finds it.
inline constexpr std::array<Quality, 3> qualities{{
    {"draft", {1, {}}, 2, 0.02F},
    {"production", {256, 0.02}, 6, 0.002F},
    {"exact", {1024, 0.005}, 32, 0.0F},
}};
inline constexpr Quality default_quality{"", {1, {}}, 4, 0.002F};

/// Null where there is none of that name.
[[nodiscard]] const Quality* find_quality(std::string_view name);

}  // namespace sheaf
