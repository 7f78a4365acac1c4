// SPDX-License-Identifier: MIT
// What a worker's end means for its job. The one place where exit codes and signals become states and problem types.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "jobs/job.hpp"
#include "jobs/worker_process.hpp"

namespace sheaf::server {

/// What is known when the worker has ended.
struct Ending {
  WorkerEnding worker;
  std::chrono::seconds wall{0};  // its limits
  std::uint64_t cpu_seconds = 0;
  bool cancel_requested = false;
  std::string message;        // the worker's error event, else its last log line
  std::uint64_t missing = 0;  // frames that should be there and are not
};

constexpr int exit_no_device = 4;  // `sheaf`: no usable device, or it was lost
constexpr int exit_storage = 6;    // reading or writing failed

struct Outcome {
  JobState state = JobState::failed;
  std::optional<Failure> failure;
};

[[nodiscard]] Outcome outcome_of(const Ending& ending);

/// Another attempt may succeed: a lost device, a disk that could not be written, or a stop or kill from outside (as by
/// a kernel that is out of memory). A crash is caused by the scene.
[[nodiscard]] bool is_transient(const Ending& ending);

/// The service or the worker ended too often to try again.
[[nodiscard]] Outcome outcome_of_too_many_starts(std::uint64_t starts);

/// The scene is no longer on the disk.
[[nodiscard]] Outcome outcome_of_lost_files();

/// The worker could not be started at all.
[[nodiscard]] Outcome outcome_of_no_start(const std::string& reason);

}  // namespace sheaf::server
