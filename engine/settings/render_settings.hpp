// SPDX-License-Identifier: MIT
// The settings of `sheaf render` as values. Fields, defaults and all that is told of them stand in table.def.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "output/compression.hpp"
#include "output/progress.hpp"
#include "sampling/pixel_samples.hpp"
#include "settings/presets.hpp"
#include "settings/values.hpp"

namespace sheaf {

enum class Strategy { automatic, hybrid, crsh, rsh, frustum, classify, bvh, brute, rayquery, reference };
constexpr auto choice_names(Strategy) {
  return std::array{"auto", "hybrid", "crsh", "rsh", "frustum", "classify", "bvh", "brute", "rayquery", "reference"};
}

enum class SortPolicy { automatic, on, off };
constexpr auto choice_names(SortPolicy) { return std::array{"auto", "on", "off"}; }

enum class CountPolicy { automatic, on, off };
constexpr auto choice_names(CountPolicy) { return std::array{"auto", "on", "off"}; }

enum class PrimaryMethod { automatic, raster, trace };
constexpr auto choice_names(PrimaryMethod) { return std::array{"auto", "raster", "trace"}; }

enum class InstancePolicy { automatic, copied, shared };
constexpr auto choice_names(InstancePolicy) { return std::array{"auto", "copied", "shared"}; }

enum class BackFaces { hide, show };
constexpr auto choice_names(BackFaces) { return std::array{"hide", "show"}; }

enum class GlassAlpha { opaque, transparent };
constexpr auto choice_names(GlassAlpha) { return std::array{"opaque", "transparent"}; }

// NOLINTBEGIN(cppcoreguidelines-macro-usage): the build makes settings_fields.def from table.def

/// What the renderer is told, beside scene and camera.
struct RenderSettings : ImageSize {
#define PICTURE(type, member, fallback) type member = fallback;
#define RUN(...)
#include "settings_fields.def"
#undef PICTURE
#undef RUN
  bool counted = true;  // whether tests are counted; what --count, --stats and --aov come to
};

/// Everything that the command line says.
struct RenderOptions {
  std::string scene;
  RenderSettings settings;
#define PICTURE(...)
#define RUN(type, member, fallback) type member = fallback;
#include "settings_fields.def"
#undef PICTURE
#undef RUN
};

// NOLINTEND(cppcoreguidelines-macro-usage)

}  // namespace sheaf
