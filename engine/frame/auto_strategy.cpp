// SPDX-License-Identifier: MIT
#include "frame/auto_strategy.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace sheaf {
namespace {

// Device time of the stages that differ between strategies, on the second of two probes: the first compiles and
// uploads.
double probe(const Device& device, const Scene& scene, const Features& features, const RenderSettings& settings,
             Strategy strategy, const FrameRequest& first) {
  Renderer renderer(device, scene, features, settings, strategy);
  (void)renderer.render(first);
  const RenderedFrame frame = renderer.render(first);
  double total = 0;
  for (const auto& [stage, ms] : frame.stats.stages_ms) total += ms;
  return total;
}

}  // namespace

Choice choose_strategy(const Device& device, const Scene& scene, const Features& features,
                       const RenderSettings& settings, const FrameRequest& first) {
  // A band of the frame at its own resolution: how tight bundles are depends on it.
  constexpr std::uint64_t probe_pixels = 96 * 1024;  // enough bundles to tell, few enough to cost little
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  Choice choice;
  if (pixels * settings.samples.most <= probe_pixels) {
    choice.strategy = Strategy::bvh;
    choice.because =
        "a frame of " + std::to_string(pixels * settings.samples.most) + " samples is too small to probe for";
    return choice;
  }
  RenderSettings small = settings;
  if (small.samples.error) small.primary = PrimaryMethod::trace;
  small.samples = {};
  small.counted = false;
  small.layers = {};
  FrameRequest band = first;
  const auto rows =
      static_cast<std::uint32_t>(std::clamp<std::uint64_t>(probe_pixels / settings.width / 8 * 8, 1, settings.height));
  band.only = Tile{0, (settings.height - rows) / 2, settings.width, rows};
  std::string measured;
  double best = 0;
  for (const auto candidate : {Strategy::hybrid, Strategy::bvh}) {
    const double ms = probe(device, scene, features, small, candidate, band);
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%s%s %.1f ms", measured.empty() ? "" : ", ", name_of(candidate), ms);
    measured += text.data();
    if (best == 0 || ms < best) {
      best = ms;
      choice.strategy = candidate;
    }
  }
  choice.because = "fastest of a probe of " + std::to_string(rows) + " rows: " + measured;
  return choice;
}

}  // namespace sheaf
