// SPDX-License-Identifier: MIT
// Which tracer the next batch goes to, and what it cost.
#include <algorithm>
#include <array>
#include <string_view>

#include "core/cpu_time.hpp"
#include "frame/renderer.hpp"

namespace sheaf {
namespace {

// What a frame pays once, whatever its rays and whoever traces them.
bool is_of_the_scene(std::string_view stage) { return stage == "animate" || stage == "objects"; }

bool is_of_the_tracer(std::string_view stage) {
  constexpr std::array others{"animate", "objects", "raster", "generate", "compact", "shade", "resolve"};
  return std::find(others.begin(), others.end(), stage) == others.end();
}

}  // namespace

Renderer::Way& Renderer::way_of(Strategy strategy) {
  const auto found = ways_.find(strategy);
  if (found != ways_.end()) return found->second;
  Way& way = ways_[strategy];
  way.strategy = strategy;
  way.plan = make_plan(features_, settings_, strategy);
  way.tracer = make_tracer({device_, *scene_, memory_, way.plan, features_, settings_, strategy, settings_.counted});
  return way;
}

// The layer of tests is one strategy's in any frame.
void Renderer::choose_way(bool frame_begins) {
  if (!automatic_ || (settings_.layers.tests && !frame_begins)) return;
  StrategyTrial& trial = automatic_->trial();
  bool made = false;
  if (trial.wants_second()) {
    const Way& second = way_of(automatic_->second());  // whose kernels are being made from now on
    made = automatic_->waits() || second.tracer->made();
  }
  way_ = &way_of(trial.next(made));
}

Renderer::Spent Renderer::spent() const {
  Spent s;
  s.cpu_ms = device_cpu_ms();
  for (const auto& [stage, ms] : recorder_.times()) {
    s.stages_ms += ms;
    if (is_of_the_scene(stage)) s.scene_ms += ms;
    if (is_of_the_tracer(stage)) s.tracing_ms += ms;
  }
  return s;
}

// A CPU device's cost is CPU time, which other programs on its cores do not disturb.
void Renderer::note_batch(const Spent& before, const Batch& batch) {
  const std::string name = name_of(way_->strategy);
  if (std::find(strategies_.begin(), strategies_.end(), name) == strategies_.end()) strategies_.push_back(name);
  if (!way_->noted) compiled_.note(way_->strategy);
  way_->noted = true;
  const auto sums = memory_.stats_readback.view<std::uint64_t>();
  std::uint64_t rays = 0;
  for (std::uint32_t kind = 0; kind < ray_kinds; ++kind) rays += sums[kind * gpu::STAT_FIELDS + gpu::STAT_RAYS];
  const std::uint64_t traced = rays - std::exchange(rays_seen_, rays);
  if (!automatic_) return;
  if (!first_made_told_) automatic_->first_made(way_->tracer->making_ms());
  first_made_told_ = true;
  const Spent now = spent();
  const double stages = now.stages_ms - before.stages_ms, of_rays = stages - (now.scene_ms - before.scene_ms);
  if (of_rays <= 0) return;
  const double cost = device_.limits().cpu ? (now.cpu_ms - before.cpu_ms) * of_rays / stages : of_rays;
  automatic_->trial().took({way_->strategy, cost, static_cast<double>(traced), static_cast<double>(batch.rays),
                            (now.tracing_ms - before.tracing_ms) / of_rays});
}

}  // namespace sheaf
