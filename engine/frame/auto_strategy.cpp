// SPDX-License-Identifier: MIT
#include "frame/auto_strategy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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
  constexpr double probe_pixels = 48 * 1024;  // enough bundles to tell, few enough to cost little
  RenderSettings small = settings;
  const double scale = std::min(1.0, std::sqrt(probe_pixels / (static_cast<double>(settings.width) * settings.height)));
  small.width = std::max(1U, static_cast<std::uint32_t>(settings.width * scale));
  small.height = std::max(1U, static_cast<std::uint32_t>(settings.height * scale));
  small.samples = 1;
  small.counted = false;
  small.layers = {};
  Choice choice;
  std::string measured;
  double best = 0;
  for (const auto candidate : {Strategy::hybrid, Strategy::bvh}) {
    const double ms = probe(device, scene, features, small, candidate, first);
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%s%s %.1f ms", measured.empty() ? "" : ", ", name_of(candidate), ms);
    measured += text.data();
    if (best == 0 || ms < best) {
      best = ms;
      choice.strategy = candidate;
    }
  }
  choice.because = "fastest of a probe of " + std::to_string(small.width) + "x" + std::to_string(small.height) +
                   " pixels: " + measured;
  return choice;
}

}  // namespace sheaf
