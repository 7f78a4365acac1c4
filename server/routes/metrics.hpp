// SPDX-License-Identifier: MIT
// Counts for /metrics, in Prometheus' text format 0.0.4.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "http/http_server.hpp"
#include "jobs/job_service.hpp"

namespace sheaf::server {

class Metrics {
 public:
  void count(const ExchangeRecord& exchange);

  /// What is so at this moment, apart from the jobs.
  struct Now {
    std::size_t streams = 0, connections = 0;
    bool device_ready = false;
    std::vector<std::string> confinement;  // of workers: what holds
  };

  /// Everything, with what `service` knows.
  [[nodiscard]] std::string text(const JobService& service, const Now& now) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, int>, std::uint64_t> requests_;  // method, status
  std::map<std::string, std::uint64_t> refusals_;                  // by the problem's slug
  Histogram times_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace sheaf::server
