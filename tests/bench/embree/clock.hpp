// SPDX-License-Identifier: MIT
// Wall time, and CPU time of all threads: the latter is what other programs on the machine disturb least.
#pragma once

#include <sys/resource.h>

#include <chrono>

namespace bench {

struct Took {
  double ms = 0, cpu_ms = 0;
};

class Clock {
 public:
  [[nodiscard]] Took read() const {
    return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun_).count(),
            cpu_ms() - cpu_begun_};
  }

 private:
  static double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    auto ms = [](const timeval& t) {
      return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
  }
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  double cpu_begun_ = cpu_ms();
};

}  // namespace bench
