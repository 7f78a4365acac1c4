// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "jobs/worker_process.hpp"

namespace sheaf::server {

/// Whether a worker finds a device: `sheaf devices` is run at the start, and again every minute while it fails.
class DeviceProbe {
 public:
  explicit DeviceProbe(std::string sheaf);
  ~DeviceProbe();
  DeviceProbe(const DeviceProbe&) = delete;
  DeviceProbe& operator=(const DeviceProbe&) = delete;

  struct Result {
    bool ready = false;
    std::string reason = "the devices are still being looked for";
  };
  [[nodiscard]] Result result() const;

 private:
  void watch();
  [[nodiscard]] Result probe();

  std::string sheaf_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Result result_;
  bool closed_ = false;
  StopSwitch stop_;
  std::thread thread_;
};

}  // namespace sheaf::server
