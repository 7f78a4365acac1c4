// SPDX-License-Identifier: MIT
// CPU time, which other programs disturb far less than wall time.
#pragma once

#include <pthread.h>

namespace sheaf {

/// Of the calling thread, milliseconds.
[[nodiscard]] double thread_cpu_ms();

/// Of this process without the threads that have said that they work beside the device. Where the device is a CPU, that
/// is what the device takes, and what feeds it. Milliseconds.
[[nodiscard]] double device_cpu_ms();

/// While it lives, its thread (which makes and ends it) works beside the device.
class BesideDevice {
 public:
  BesideDevice();
  BesideDevice(const BesideDevice&) = delete;
  BesideDevice& operator=(const BesideDevice&) = delete;
  ~BesideDevice();

 private:
  friend double device_cpu_ms();
  [[nodiscard]] double taken_ms() const;
  clockid_t clock_{};
  double begun_ms_ = 0;
};

}  // namespace sheaf
