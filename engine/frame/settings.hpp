// SPDX-License-Identifier: MIT
// Everything that decides a picture besides scene and camera, and what else to report about it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sampling/pixel_samples.hpp"
#include "sampling/quality.hpp"

namespace sheaf {

enum class Strategy { automatic, hybrid, crsh, rsh, frustum, classify, bvh, brute, rayquery, reference };
enum class SortPolicy { automatic, on, off };
enum class PrimaryMethod { automatic, raster, trace };
enum class InstancePolicy { automatic, copied, shared };

[[nodiscard]] Strategy parse_strategy(const std::string& name);  // Error{usage} naming what there is
[[nodiscard]] const char* name_of(Strategy strategy);

struct LayerSet {  // --aov
  bool depth = false, normal = false, position = false, albedo = false, uv = false, id = false, tests = false;
  [[nodiscard]] bool any_surface() const { return depth || normal || position || albedo || uv || id; }
};

[[nodiscard]] LayerSet parse_layers(const std::string& list);  // "Z,N,P,albedo,UV,id,tests" or "all"

struct RenderSettings {
  std::uint32_t width = 1280, height = 720;
  SampleCount samples;
  PixelFilter filter = PixelFilter::gaussian;
  std::uint32_t depth = 4;
  float cutoff = 0.002F;
  Strategy strategy = Strategy::automatic;
  SortPolicy sort = SortPolicy::automatic;
  PrimaryMethod primary = PrimaryMethod::automatic;
  InstancePolicy instances = InstancePolicy::automatic;
  bool opaque = false;
  bool transparent_glass = false;  // what is seen through transmission is not covered: alpha below 1
  LayerSet layers;
  float z_background = 1e10F;       // of layer Z where nothing was hit
  std::uint32_t most_pixels = ~0U;  // of a tile: a probe needs no lists for a whole frame
  std::uint64_t memory_mib = 1024;  // for rays, pairs and what else scales with the picture, not with the scene
  std::optional<glm::vec3> environment;
  bool counted = true;
};

[[nodiscard]] SampleCount parse_samples(const std::string& text);     // Error{usage}
[[nodiscard]] const Quality& parse_quality(const std::string& name);  // Error{usage}; empty: the defaults
[[nodiscard]] PixelFilter parse_filter(const std::string& name);
[[nodiscard]] const char* name_of(PixelFilter filter);

/// Throws Error{input} naming the setting, its value and its bounds.
void check_settings(const RenderSettings& settings);

}  // namespace sheaf
