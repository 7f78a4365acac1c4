// SPDX-License-Identifier: MIT
// Samples per pixel: the same for all, or as many as its error asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sheaf {

struct SampleCount {
  std::uint32_t most = 1;       // per pixel; where they are not adaptive, of every pixel
  std::optional<double> error;  // adaptive: see AdaptivePixels
};

/// "N", or "adaptive:ERROR" with an optional ":MOST"; nothing where it is neither. A number of samples that is too
/// large for its type becomes the largest. Ranges are the caller's matter.
[[nodiscard]] std::optional<SampleCount> parse_sample_count(std::string_view text);
[[nodiscard]] std::string text_of(const SampleCount& samples);

}  // namespace sheaf
