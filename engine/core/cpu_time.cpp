// SPDX-License-Identifier: MIT
#include "core/cpu_time.hpp"

#include <ctime>
#include <mutex>
#include <set>

namespace sheaf {
namespace {

double read_ms(clockid_t clock) {
  timespec time{};
  if (clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

struct Threads {
  std::mutex mutex;
  std::set<const BesideDevice*> working;
  double ended_ms = 0;  // what those took that are done
};

Threads& threads() {
  static Threads all;
  return all;
}

}  // namespace

double thread_cpu_ms() { return read_ms(CLOCK_THREAD_CPUTIME_ID); }

BesideDevice::BesideDevice() {
  if (pthread_getcpuclockid(pthread_self(), &clock_) != 0) clock_ = CLOCK_THREAD_CPUTIME_ID;
  begun_ms_ = read_ms(clock_);
  const std::scoped_lock lock(threads().mutex);
  threads().working.insert(this);
}

BesideDevice::~BesideDevice() {
  const std::scoped_lock lock(threads().mutex);
  threads().working.erase(this);
  threads().ended_ms += taken_ms();
}

double BesideDevice::taken_ms() const { return read_ms(clock_) - begun_ms_; }

double device_cpu_ms() {
  const std::scoped_lock lock(threads().mutex);
  double beside = threads().ended_ms;
  for (const auto* thread : threads().working) beside += thread->taken_ms();
  return read_ms(CLOCK_PROCESS_CPUTIME_ID) - beside;
}

}  // namespace sheaf
