// SPDX-License-Identifier: MIT
// Sums over the workers' stats.json since the start, for /metrics.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

namespace sheaf::server {

/// Counts of values by size. The bounds are seconds, from what a stage takes to what a frame takes.
struct Histogram {
  static constexpr std::array bounds{0.0001, 0.0005, 0.001, 0.005, 0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 30.0};
  std::array<std::uint64_t, bounds.size() + 1> counts{};  // the last: above every bound
  double sum = 0;

  void add(double value);
};

class WorkTotals {
 public:
  struct Sums {
    std::map<std::string, Histogram> stages;  // and "frame": all of one
    std::map<std::string, std::uint64_t> rays;
    std::map<std::pair<std::string, std::string>, std::uint64_t> tests;  // kind of test, kind of ray
    std::string device, driver;                                          // of the last job
    double peak_device_mib = 0;
  };

  /// Adds a worker's stats; values that are missing or malformed are ignored.
  void add(const std::filesystem::path& stats);
  [[nodiscard]] Sums sums() const;

 private:
  mutable std::mutex mutex_;
  Sums sums_;
};

}  // namespace sheaf::server
