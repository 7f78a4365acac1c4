// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "jobs/job.hpp"
#include "jobs/work_totals.hpp"

namespace sheaf::server {

/// Counts since the start; they only grow.
struct Counters {
  std::atomic<std::uint64_t> jobs_accepted{0}, frames_rendered{0};
  std::array<std::atomic<std::uint64_t>, 5> jobs_ended{};  // by JobState
  std::atomic<std::uint64_t> worker_starts{0}, workers_tried_again{0}, devices_missed{0};
  WorkTotals work;

  void ended(JobState state) { ++jobs_ended[static_cast<std::size_t>(state)]; }
};

}  // namespace sheaf::server
