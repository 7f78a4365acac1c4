// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "jobs/confinement.hpp"
#include "jobs/worker_process.hpp"

namespace sheaf::server {

/// Whether a worker finds a device. `sheaf devices`, confined as workers are, runs at the start, every minute while it
/// fails, and when somebody asks after a worker had no device or lost it.
class DeviceProbe {
 public:
  /// `losses`: how many workers had no device or lost it.
  DeviceProbe(std::string sheaf, ConfinementOptions confinement, const std::atomic<std::uint64_t>& losses);
  ~DeviceProbe();
  DeviceProbe(const DeviceProbe&) = delete;
  DeviceProbe& operator=(const DeviceProbe&) = delete;

  struct Result {
    bool ready = false;
    std::string reason = "the devices are still being looked for";
  };
  [[nodiscard]] Result result();

 private:
  void watch();
  [[nodiscard]] Result probe();

  std::string sheaf_;
  ConfinementOptions confinement_;
  const std::atomic<std::uint64_t>& losses_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Result result_;
  std::uint64_t losses_seen_ = 0;
  bool closed_ = false, recheck_ = false;
  StopSwitch stop_;
  std::thread thread_;
};

}  // namespace sheaf::server
