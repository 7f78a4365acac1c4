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

constexpr std::uint32_t block = 8;  // rows of a block of pixels, see generate_primary.comp

// Bands of the frame at its own resolution, spread over its height: how tight bundles are depends on the resolution,
// and on what is seen (a city's horizon is where its rays part, its streets where they do not).
std::vector<Tile> bands_of(const RenderSettings& settings, std::uint64_t pixels) {
  constexpr std::uint32_t most = 2;
  const auto rows = static_cast<std::uint32_t>(std::min<std::uint64_t>(pixels / settings.width, settings.height));
  const std::uint32_t height =
      std::clamp(rows / most / block * block, std::min(block, settings.height), settings.height);
  const std::uint32_t bands = std::clamp(rows / height, 1U, most);
  std::vector<Tile> tiles;
  for (std::uint32_t b = 0; b < bands; ++b)
    tiles.push_back({0, (settings.height - height) * (2 * b + 1) / (2 * bands), settings.width, height});
  return tiles;
}

// The first rows of a band: what it takes is, but for a little, what launches do.
Tile sliver_of(const Tile& band) { return {band.x, band.y, band.width, std::min(block, band.height)}; }

// What each band pays for the whole scene, and the frame but once, whatever the strategy.
bool is_of_the_scene(const std::string& stage) { return stage == "animate" || stage == "objects" || stage == "raster"; }

// What a strategy takes for some bands and a sliver: of each the least of several turns, since what disturbs a machine
// only adds.
struct Contender {
  static constexpr double never = std::numeric_limits<double>::infinity();
  Strategy strategy = Strategy::bvh;
  std::unique_ptr<Renderer> renderer;
  std::vector<double> least_ms;  // of each band
  double sliver_ms = never;

  [[nodiscard]] double time_of(FrameRequest request, const Tile& tile) const {
    request.only = tile;
    double total = 0;
    for (const auto& [stage, ms] : renderer->render(request).stats.stages_ms) total += is_of_the_scene(stage) ? 0 : ms;
    return total;
  }

  void take_turn(const FrameRequest& request, const std::vector<Tile>& bands) {
    least_ms.resize(bands.size(), never);
    for (std::size_t b = 0; b < bands.size(); ++b) least_ms[b] = std::min(least_ms[b], time_of(request, bands[b]));
  }

  /// A frame of `rows`, foretold: a band pays for its launches again, and hybrid for more of them.
  [[nodiscard]] double frame_ms(const Tile& of_bands, const Tile& sliver, std::uint32_t rows) const {
    const double band = std::accumulate(least_ms.begin(), least_ms.end(), 0.0) / static_cast<double>(least_ms.size());
    if (of_bands.height <= sliver.height) return band * rows / of_bands.height;
    return sliver_ms + std::max(band - sliver_ms, 0.0) * (rows - sliver.height) / (of_bands.height - sliver.height);
  }
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
  const Tile sliver = sliver_of(bands.front());
  small.most_pixels = higher.front().pixels() * 5 / 4;  // a band may make more rays a pixel than a frame
  std::array<Contender, 2> contenders;
  contenders[0].strategy = Strategy::bvh;
  contenders[1].strategy = Strategy::hybrid;
  for (auto& contender : contenders) {
    contender.renderer = std::make_unique<Renderer>(device, scene, features, small, contender.strategy);
    contender.take_turn(first, {bands.front()});  // compiles and uploads
  }
  const Contender &plain = contenders.front(), &bundled = contenders.back();
  double plain_ms = 0, bundled_ms = 0;
  const auto compare = [&](int turns) {
    for (auto& contender : contenders) contender.least_ms.clear();
    for (int turn = 0; turn < turns; ++turn)
      for (auto& contender : contenders) contender.take_turn(first, bands);
    plain_ms = plain.frame_ms(bands.front(), sliver, settings.height);
    bundled_ms = bundled.frame_ms(bands.front(), sliver, settings.height);
  };
  constexpr int turns = 3;
  for (int turn = 0; turn < turns; ++turn)
    for (auto& c : contenders) c.sliver_ms = std::min(c.sliver_ms, c.time_of(first, sliver));
  compare(turns);
  // Where they are close, higher bands tell.
  if (std::abs(bundled_ms / plain_ms - 1) < 0.12 && higher.front().height > bands.front().height) {
    bands = higher;
    compare(2);
  }
  scene->forget();  // the first frame's figures are of all that it needs
  choice.strategy = bundled_ms < plain_ms ? bundled.strategy : plain.strategy;
  std::array<char, 96> foretold{};
  std::snprintf(foretold.data(), foretold.size(), "bvh %.1f ms, hybrid %.1f ms", plain_ms, bundled_ms);
  choice.because = "the faster, foretold from a probe of " + std::to_string(bands.size()) + " bands of " +
                   std::to_string(bands.front().height) + " rows: " + foretold.data();
  return choice;
}

}  // namespace sheaf
