// SPDX-License-Identifier: MIT
#include "frame/strategy_trial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace sheaf {
namespace {

// A look by the other strategy costs a span of batches at its disadvantage. So many spans apart, looks cost at most
// half a percent.
constexpr double spans_between_looks = 200;
constexpr std::uint32_t least_spans = 8;
constexpr double much = 1.5;  // rays, or cost of a ray, that changed by this factor are other work

}  // namespace

double StrategyTrial::Side::ratio(double BatchTaken::*of, double BatchTaken::*per) const {
  double above = 0, below = 0;
  for (const auto& batch : last) {
    above += batch.*of;
    below += batch.*per;
  }
  return below > 0 ? above / below : 0;
}

// Of the run, by the strategy at work.
double StrategyTrial::left_ms() const {
  return std::max(terms_.camera_rays - done_, 0.0) * side(now_).ratio(&BatchTaken::cost_ms, &BatchTaken::camera_rays);
}

Strategy StrategyTrial::next(bool second_made) {
  if (phase_ == Phase::making && second_made) phase_ = Phase::warming;
  const bool tries = phase_ == Phase::warming || phase_ == Phase::measuring;
  return tries ? other() : now_;
}

void StrategyTrial::took(const BatchTaken& batch) {
  ++batches_;
  done_ += batch.camera_rays;
  const bool tries = phase_ == Phase::warming || phase_ == Phase::measuring;
  if (tries != (batch.by != now_)) return;  // not yet by whom it should be, where only whole frames change hands
  if (phase_ == Phase::warming) {           // its kernels came from the cache, or were compiled
    phase_ = Phase::measuring;
    tried_ = 0;
    return;
  }
  if (batch.rays <= 0 || (batches_ == 1 && terms_.compiles_first)) return;
  auto& last = side(batch.by).last;
  if (phase_ == Phase::measuring && tried_ == 0) last.clear();
  last.push_back(batch);
  while (last.size() > terms_.span) last.pop_front();
  if (phase_ == Phase::alone) consider();
  if (phase_ == Phase::measuring && ++tried_ >= terms_.span) compare();
  if (phase_ == Phase::settled) {
    ++since_;
    if (time_to_look()) {
      phase_ = Phase::measuring;
      tried_ = 0;
    }
  }
}

void StrategyTrial::consider() {
  double tracing = 0, cost = 0;
  for (const auto& batch : first_.last) {
    tracing += batch.tracing * batch.cost_ms;
    cost += batch.cost_ms;
  }
  const double gain = cost > 0 ? left_ms() * tracing / cost * terms_.saving : 0;
  best_gain_ms_ = std::max(best_gain_ms_, gain);
  if (gain > terms_.price_ms) phase_ = Phase::making;
}

void StrategyTrial::compare() {
  first_per_ray_ = first_.per_ray();
  second_per_ray_ = second_.per_ray();
  const Strategy better = second_per_ray_ < first_per_ray_ ? terms_.second : terms_.first;
  const double high = std::max(first_per_ray_, second_per_ray_), low = std::min(first_per_ray_, second_per_ray_);
  const auto apart = static_cast<std::uint32_t>(std::lround((high / low - 1) * spans_between_looks));
  const std::uint32_t least = terms_.span * std::clamp(apart, least_spans, 1024U);
  wait_ = better == now_ && looks_ > 0 ? std::max(2 * wait_, least) : least;
  now_ = better;
  ++looks_;
  since_ = 0;
  settled_per_ray_ = side(now_).per_ray();
  settled_rays_ = side(now_).rays_per_camera_ray();
  phase_ = Phase::settled;
}

bool StrategyTrial::changed() const {
  const auto differ = [](double a, double b) { return a > much * b || b > much * a; };
  const Side& mine = side(now_);
  return differ(mine.per_ray(), settled_per_ray_) || differ(mine.rays_per_camera_ray(), settled_rays_);
}

bool StrategyTrial::time_to_look() const {
  if (since_ < std::min(wait_, least_spans * terms_.span)) return false;
  if (since_ < wait_ && !changed()) return false;
  // A look pays in what follows it.
  const double camera_rays = done_ / batches_;
  return terms_.camera_rays - done_ > 4 * terms_.span * camera_rays;
}

std::string StrategyTrial::because() const {
  std::array<char, 240> text{};
  const char *first = name_of(terms_.first), *second = name_of(terms_.second);
  if (looks_ > 0) {
    const bool wins = now_ == terms_.second;
    std::snprintf(text.data(), text.size(),
                  "the cheaper as measured on batches of this run: %s %.0f ns per ray, %s %.0f", wins ? second : first,
                  1e6 * (wins ? second_per_ray_ : first_per_ray_), wins ? first : second,
                  1e6 * (wins ? first_per_ray_ : second_per_ray_));
  } else if (phase_ == Phase::alone) {
    std::snprintf(text.data(), text.size(), "%s could save %.2f s of what is left, and its kernels take %.2f s to make",
                  second, best_gain_ms_ / 1e3, terms_.price_ms / 1e3);
  } else {
    std::snprintf(text.data(), text.size(), "%.0f camera rays ended before %s was measured", terms_.camera_rays,
                  second);
  }
  return text.data();
}

}  // namespace sheaf
