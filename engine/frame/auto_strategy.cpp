// SPDX-License-Identifier: MIT
#include "frame/auto_strategy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace sheaf {
namespace {

// Bands of the frame at its own resolution, spread over its height: how tight bundles are depends on the resolution,
// and on what is seen (a city's horizon is where its rays part, its streets where they do not).
std::vector<Tile> bands_of(const RenderSettings& settings, std::uint64_t pixels) {
  // Each band pays for its launches again, hybrid for more of them: bands of 24 and 32 rows made it lose where it wins.
  constexpr std::uint32_t most = 2, block = 8;  // rows of a block of pixels, see generate_primary.comp
  const auto rows = static_cast<std::uint32_t>(std::min<std::uint64_t>(pixels / settings.width, settings.height));
  const std::uint32_t height =
      std::clamp(rows / most / block * block, std::min(block, settings.height), settings.height);
  const std::uint32_t bands = std::clamp(rows / height, 1U, most);
  std::vector<Tile> tiles;
  for (std::uint32_t b = 0; b < bands; ++b)
    tiles.push_back({0, (settings.height - height) * (2 * b + 1) / (2 * bands), settings.width, height});
  return tiles;
}

// What each band pays for the whole scene, and the frame but once, whatever the strategy.
bool is_of_the_scene(const std::string& stage) { return stage == "animate" || stage == "objects" || stage == "raster"; }

// What a strategy takes for some bands: of each the least of several turns, since what disturbs a machine only adds.
struct Contender {
  Strategy strategy;
  std::unique_ptr<Renderer> renderer;
  std::vector<double> least_ms;  // of each band

  void take_turn(FrameRequest request, const std::vector<Tile>& bands) {
    least_ms.resize(bands.size(), std::numeric_limits<double>::infinity());
    for (std::size_t b = 0; b < bands.size(); ++b) {
      request.only = bands[b];
      double total = 0;
      for (const auto& [stage, ms] : renderer->render(request).stats.stages_ms)
        total += is_of_the_scene(stage) ? 0 : ms;
      least_ms[b] = std::min(least_ms[b], total);
    }
  }
  [[nodiscard]] double total_ms() const { return std::accumulate(least_ms.begin(), least_ms.end(), 0.0); }
};

}  // namespace

Choice choose_strategy(const Device& device, const std::shared_ptr<DeviceScene>& scene, const Features& features,
                       const RenderSettings& settings, const FrameRequest& first) {
  // Below the first a probe would take about as long as the frame; the second holds enough bundles to tell.
  constexpr std::uint64_t least_pixels = 96 * 1024, probe_pixels = 192 * 1024;
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  Choice choice;
  if (pixels * settings.samples.most <= least_pixels) {
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
  auto bands = bands_of(settings, probe_pixels);
  const auto higher = bands_of(settings, 2 * probe_pixels);
  small.most_pixels = higher.front().pixels() * 5 / 4;  // a band may make more rays a pixel than a frame
  std::array<Contender, 2> contenders{Contender{Strategy::bvh, {}, {}}, Contender{Strategy::hybrid, {}, {}}};
  for (auto& contender : contenders) {
    contender.renderer = std::make_unique<Renderer>(device, scene, features, small, contender.strategy);
    contender.take_turn(first, bands);  // compiles and uploads
  }
  const Contender &plain = contenders.front(), &bundled = contenders.back();
  const auto compare = [&](int turns) {
    for (auto& contender : contenders) contender.least_ms.clear();
    for (int turn = 0; turn < turns; ++turn)
      for (auto& contender : contenders) contender.take_turn(first, bands);
    return bundled.total_ms() / plain.total_ms();
  };
  // Launches, of which hybrid has more, weigh more in a band than in a frame: where that may matter, higher bands tell.
  if (std::abs(compare(3) - 1) < 0.12 && higher.front().height > bands.front().height) {
    bands = higher;
    compare(2);
  }
  scene->forget();  // the first frame's figures are of all that it needs
  choice.strategy = bundled.total_ms() < plain.total_ms() ? bundled.strategy : plain.strategy;
  std::array<char, 96> measured{};
  std::snprintf(measured.data(), measured.size(), "bvh %.1f ms, hybrid %.1f ms", plain.total_ms(), bundled.total_ms());
  choice.because = "the faster in a probe of " + std::to_string(bands.size()) + " bands of " +
                   std::to_string(bands.front().height) + " rows: " + measured.data();
  return choice;
}

}  // namespace sheaf
