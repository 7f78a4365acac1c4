// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>

#include "output/layer_set.hpp"

namespace sheaf {

enum class Compression { none, rle, zips, zip, piz, dwaa };
constexpr auto choice_names(Compression) { return std::array{"none", "rle", "zips", "zip", "piz", "dwaa"}; }

/// DWAA tells colour from data by a channel's last letter, and would put P.Y, N.Y and UV.Y through its lossy transform.
/// Says why layers cannot go with this compression; empty where they can.
[[nodiscard]] std::string compression_conflict(Compression compression, const LayerSet& layers);

/// What readers of such files are known to lack, for a warning; empty where there is nothing to say.
[[nodiscard]] std::string compression_warning(Compression compression, const LayerSet& layers);

}  // namespace sheaf
