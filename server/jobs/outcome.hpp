// SPDX-License-Identifier: MIT
// What a worker's end means for its job. The one place where exit codes and signals become states and problem types.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "jobs/job.hpp"
#include "jobs/worker_process.hpp"

namespace sheaf::server {

/// What is known when the worker has ended.
struct Ending {
  WorkerEnding worker;
  bool cancel_requested = false;
  std::string message;        // the worker's last word: its error event, else its last log line
  std::uint64_t missing = 0;  // frames that should be there and are not
};

struct Outcome {
  JobState state = JobState::failed;
  std::optional<Failure> failure;
};

[[nodiscard]] Outcome outcome_of(const Ending& ending);

/// The worker could not be started at all.
[[nodiscard]] Outcome outcome_of_no_start(const std::string& reason);

}  // namespace sheaf::server
