// SPDX-License-Identifier: MIT
// `--strategy auto`: bvh and hybrid, tried on work that counts (strategy_trial.hpp), at prices for the making of
// kernels that depend on whether the driver has them in its cache.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "device_data/features.hpp"
#include "frame/strategy_trial.hpp"
#include "vulkan/device.hpp"

namespace sheaf {

/// Which kernels drivers have compiled before: a file each beside their caches, so that it is lost with them.
class CompiledKernels {
 public:
  CompiledKernels(const Device& device, const Features& features, const RenderSettings& settings, const Plan& plan);
  [[nodiscard]] bool hold(Strategy strategy) const;
  /// To be told when `strategy` has traced. Where no file can be written nothing is kept.
  void note(Strategy strategy) const;

 private:
  [[nodiscard]] std::string path(Strategy strategy) const;
  std::string folder_, variant_;
};

class AutoStrategy {
 public:
  struct Run {
    std::uint64_t frames = 1;     // that are not the same picture again
    std::uint64_t triangles = 0;  // with all instances
    std::uint32_t tiles = 1;      // of a frame
  };
  AutoStrategy(const Device& device, const RenderSettings& settings, const CompiledKernels& compiled, const Run& run);

  [[nodiscard]] Strategy first() const { return terms_.first; }
  [[nodiscard]] Strategy second() const { return terms_.second; }
  [[nodiscard]] StrategyTrial& trial() { return trial_; }
  [[nodiscard]] const StrategyTrial& trial() const { return trial_; }
  /// What the first strategy's kernels took to be made, CPU time: the second's are predicted from it.
  void first_made(double cpu_ms);
  /// Whether to wait for the second's kernels, where else the first goes on: then what happens does not depend on time.
  [[nodiscard]] bool waits() const { return given_price_.has_value(); }

 private:
  bool cpu_;
  std::uint32_t workers_;
  bool first_compiled_, second_compiled_;
  std::optional<double> given_price_;  // SHEAF_AUTO_PRICE, milliseconds: for tests
  TrialTerms terms_;
  StrategyTrial trial_;
};

}  // namespace sheaf
