// SPDX-License-Identifier: MIT
// Which of two strategies traces the next batch of rays, where both give the same bytes: the first until the other's
// kernels are worth making, then both in turn on work that counts, then the cheaper.
//
// Costs are milliseconds of whatever the caller measures (CPU time of a CPU device, else time of the device); prices
// are in the same unit. Pure arithmetic: knows no device.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>

#include "settings/render_settings.hpp"

namespace sheaf {

struct TrialTerms {
  Strategy first = Strategy::bvh, second = Strategy::hybrid;
  double camera_rays = 0;       // of the whole run: its frames' pixels times samples
  double saving = 0;            // expected of `second`: this part of what `first` spends on finding hits
  double price_ms = 0;          // to make `second`'s kernels
  std::uint32_t span = 1;       // batches that make a fair sample: tiles of a frame, as these may be unlike
  bool compiles_first = false;  // `first`'s kernels are compiled within its first batch, which then tells nothing
};

struct BatchTaken {
  Strategy by = Strategy::bvh;
  double cost_ms = 0;
  double rays = 0;         // all that were traced
  double camera_rays = 0;  // of them, those from the camera
  double tracing = 0;      // part of the cost that was for finding hits: 0 to 1
};

class StrategyTrial {
 public:
  explicit StrategyTrial(const TrialTerms& terms) : terms_(terms), now_(terms.first) {}

  /// What it costs to make `second`'s kernels is known better once the first's are made.
  void set_price(double ms) { terms_.price_ms = ms; }
  /// Whether `second`'s kernels are to be made now; true from then on.
  [[nodiscard]] bool wants_second() const { return phase_ != Phase::alone; }
  /// Who traces the next batch; `second_made`: its kernels are there.
  [[nodiscard]] Strategy next(bool second_made);
  /// A batch that `next` named a strategy for, or that went on by the one before.
  void took(const BatchTaken& batch);

  /// The one that is kept, for what is known.
  [[nodiscard]] Strategy kept() const { return now_; }
  [[nodiscard]] std::string because() const;

 private:
  enum class Phase { alone, making, warming, measuring, settled };
  struct Side {
    std::deque<BatchTaken> last;  // at most `span`
    [[nodiscard]] double ratio(double BatchTaken::*of, double BatchTaken::*per) const;
    [[nodiscard]] double per_ray() const { return ratio(&BatchTaken::cost_ms, &BatchTaken::rays); }
    [[nodiscard]] double rays_per_camera_ray() const { return ratio(&BatchTaken::rays, &BatchTaken::camera_rays); }
  };

  [[nodiscard]] Side& side(Strategy s) { return s == terms_.first ? first_ : second_; }
  [[nodiscard]] const Side& side(Strategy s) const { return s == terms_.first ? first_ : second_; }
  [[nodiscard]] Strategy other() const { return now_ == terms_.first ? terms_.second : terms_.first; }
  [[nodiscard]] double left_ms() const;
  void consider();
  void compare();
  [[nodiscard]] bool changed() const;
  [[nodiscard]] bool time_to_look() const;

  TrialTerms terms_;
  Strategy now_;
  Phase phase_ = Phase::alone;
  Side first_, second_;
  std::uint32_t batches_ = 0, tried_ = 0, since_ = 0, wait_ = 0, longest_wait_ = 0;
  double done_ = 0;                                // camera rays
  double settled_per_ray_ = 0, settled_rays_ = 0;  // of the one kept, when it was found better
  double first_per_ray_ = 0, second_per_ray_ = 0;  // as last compared
  double best_gain_ms_ = 0;                        // the most that `second` could have saved
  std::uint32_t looks_ = 0;
};

}  // namespace sheaf
