// SPDX-License-Identifier: MIT
#include "frame/settings.hpp"

#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "sampling/adaptive_pixels.hpp"

namespace sheaf {
namespace {

constexpr std::array<std::pair<Strategy, const char*>, 10> strategies{{{Strategy::automatic, "auto"},
                                                                       {Strategy::hybrid, "hybrid"},
                                                                       {Strategy::crsh, "crsh"},
                                                                       {Strategy::rsh, "rsh"},
                                                                       {Strategy::frustum, "frustum"},
                                                                       {Strategy::classify, "classify"},
                                                                       {Strategy::bvh, "bvh"},
                                                                       {Strategy::brute, "brute"},
                                                                       {Strategy::rayquery, "rayquery"},
                                                                       {Strategy::reference, "reference"}}};

constexpr std::array<std::pair<PixelFilter, const char*>, 3> filters{
    {{PixelFilter::box, "box"}, {PixelFilter::triangle, "triangle"}, {PixelFilter::gaussian, "gaussian"}}};

template <typename T>
void check_range(const char* name, T value, T low, T high) {
  if (value >= low && value <= high) return;  // false for a NaN
  std::ostringstream text;
  text << "--" << name << " " << value << ": must be between " << low << " and " << high;
  throw Error(ErrorKind::input, text.str());
}

}  // namespace

Strategy parse_strategy(const std::string& name) {
  std::string known;
  for (const auto& [value, text] : strategies) {
    if (name == text) return value;
    known += std::string(known.empty() ? "" : ", ") + text;
  }
  throw Error(ErrorKind::usage, "--strategy " + quote(name) + ": there is " + known);
}

const char* name_of(Strategy strategy) {
  for (const auto& [value, text] : strategies)
    if (value == strategy) return text;
  return "?";
}

PixelFilter parse_filter(const std::string& name) {
  for (const auto& [value, text] : filters)
    if (name == text) return value;
  throw Error(ErrorKind::usage, "--filter " + quote(name) + ": there is box, triangle, gaussian");
}

const char* name_of(PixelFilter filter) {
  for (const auto& [value, text] : filters)
    if (value == filter) return text;
  return "?";
}

const Quality& parse_quality(const std::string& name) {
  if (name.empty()) return default_quality;
  if (const Quality* quality = find_quality(name)) return *quality;
  throw Error(ErrorKind::usage, "--quality " + quote(name) + ": there is draft, production, exact");
}

SampleCount parse_samples(const std::string& text) {
  if (const auto samples = parse_sample_count(text)) return *samples;
  throw Error(ErrorKind::usage, "--spp " + quote(text) + ": must be a whole number or adaptive:ERROR[:MOST]");
}

LayerSet parse_layers(const std::string& list) {
  LayerSet layers;
  std::stringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    const bool all = part == "all";
    bool known = all;
    auto take = [&](const char* name, bool& flag) {
      if (!all && part != name) return;
      flag = known = true;
    };
    take("Z", layers.depth);
    take("N", layers.normal);
    take("P", layers.position);
    take("albedo", layers.albedo);
    take("UV", layers.uv);
    take("id", layers.id);
    take("tests", layers.tests);
    if (!known)
      throw Error(ErrorKind::usage, "--aov " + quote(part) + ": there is Z, N, P, albedo, UV, id, tests, all");
  }
  return layers;
}

void check_settings(const RenderSettings& settings) {
  check_range("size (width)", settings.width, 1U, 16384U);
  check_range("size (height)", settings.height, 1U, 16384U);
  check_range("spp", settings.samples.most, 1U, 65536U);
  if (settings.samples.error) {
    check_range("spp adaptive: error", *settings.samples.error, 1e-5, 1.0);
    check_range("spp adaptive: most samples", settings.samples.most, 2 * AdaptivePixels::first_round, 65536U);
  }
  check_range("depth", settings.depth, 0U, 4096U);
  check_range("cutoff", settings.cutoff, 0.0F, 1.0F);
  check_range<std::uint64_t>("memory", settings.memory_mib, 16, 1U << 20U);
  if (settings.environment)
    for (int c = 0; c < 3; ++c) check_range("environment", (*settings.environment)[c], 0.0F, 1e6F);
}

}  // namespace sheaf
