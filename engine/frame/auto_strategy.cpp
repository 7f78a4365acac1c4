// SPDX-License-Identifier: MIT
#include "frame/auto_strategy.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <memory>

namespace sheaf {
namespace {

// What a strategy takes for a band of the frame: the least of several turns, since what disturbs a machine only adds.
struct Contender {
  Strategy strategy;
  std::unique_ptr<Renderer> renderer;
  double least_ms = std::numeric_limits<double>::infinity();

  void take_turn(const FrameRequest& band) {
    double total = 0;
    for (const auto& [stage, ms] : renderer->render(band).stats.stages_ms) total += ms;
    least_ms = std::min(least_ms, total);
  }
};

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
  std::array<Contender, 2> contenders{Contender{Strategy::bvh, {}}, Contender{Strategy::hybrid, {}}};
  for (auto& contender : contenders) {
    contender.renderer = std::make_unique<Renderer>(device, scene, features, small, contender.strategy);
    (void)contender.renderer->render(band);  // compiles and uploads
  }
  constexpr int turns = 3;
  for (int turn = 0; turn < turns; ++turn)
    for (auto& contender : contenders) contender.take_turn(band);
  const auto& [plain, bundled] = contenders;
  // A tie goes to bvh: it starts sooner, and needs less memory.
  choice.strategy = bundled.least_ms < 0.95 * plain.least_ms ? bundled.strategy : plain.strategy;
  std::array<char, 96> measured{};
  std::snprintf(measured.data(), measured.size(), "bvh %.1f ms, hybrid %.1f ms", plain.least_ms, bundled.least_ms);
  choice.because =
      "the faster by a twentieth, or bvh, of a probe of " + std::to_string(rows) + " rows: " + measured.data();
  return choice;
}

}  // namespace sheaf
