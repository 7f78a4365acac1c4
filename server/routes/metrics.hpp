// SPDX-License-Identifier: MIT
// Counts for /metrics, in Prometheus' text format 0.0.4.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "http/http_server.hpp"
#include "jobs/job_service.hpp"

namespace sheaf::server {

class Metrics {
 public:
  void count(const ExchangeRecord& exchange);

  /// Everything, with what `service` knows and the counts of streams and connections held now.
  [[nodiscard]] std::string text(const JobService& service, std::size_t streams, std::size_t connections) const;

 private:
  // Upper bounds of the buckets of request times, in seconds.
  static constexpr std::array bounds{0.001, 0.005, 0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 30.0};

  mutable std::mutex mutex_;
  std::map<std::pair<std::string, int>, std::uint64_t> requests_;  // method, status
  std::array<std::uint64_t, bounds.size() + 1> times_{};           // the last: above every bound
  double seconds_ = 0;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace sheaf::server
