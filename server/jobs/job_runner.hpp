// SPDX-License-Identifier: MIT
// Runs a job in one worker process, or several if a process is killed: its command line, and what its end means.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "jobs/confinement.hpp"
#include "jobs/counters.hpp"
#include "jobs/job_change.hpp"
#include "jobs/job_files.hpp"
#include "jobs/job_store.hpp"
#include "jobs/limits.hpp"
#include "jobs/worker_process.hpp"

namespace sheaf::server {

struct RunnerOptions {
  std::string sheaf;                            // the worker's program
  std::chrono::milliseconds grace{5000};        // from SIGTERM to SIGKILL
  std::chrono::milliseconds cancel_grace{500};  // the same for a cancelled job, which is to end within a second
  std::chrono::seconds retention{7 * 86'400};   // how long a finished job is kept; 0: for ever
  std::uint64_t log_bytes = Limits{}.log_bytes;
  std::chrono::seconds wall{7 * 86'400};  // how long a worker may run; 0: any time
  ConfinementOptions confinement;
  std::uint64_t attempts = 3;  // starts without a new frame, after ends that the scene did not cause
};

class JobRunner {
 public:
  /// `disk_is_writable`: whether a job that could not write its frames may try again.
  JobRunner(RunnerOptions options, JobStore& store, const JobFiles& files, Counters& counters,
            std::function<bool()> disk_is_writable)
      : options_(std::move(options)),
        store_(store),
        files_(files),
        counters_(counters),
        disk_is_writable_(std::move(disk_is_writable)) {}

  /// Runs a queued job to its end; does nothing for one that is not queued any more. Never throws.
  void run(const std::string& id, const StopSwitch& stop) const noexcept;

  [[nodiscard]] const RunnerOptions& options() const { return options_; }

 private:
  [[nodiscard]] std::vector<std::string> command_of(const Job& job) const;
  [[nodiscard]] std::optional<Job> begin(const std::string& id, bool again) const;
  [[nodiscard]] struct Ending run_worker_of(const Job& job, const StopSwitch& stop) const;
  enum class Next { ended, queued, again, when_disk_is_writable };
  [[nodiscard]] Next attempt(const Job& job, const StopSwitch& stop) const;
  [[nodiscard]] bool wait_for_disk(const StopSwitch& stop) const;
  void conclude(const std::string& id, const struct Outcome& outcome) const;

  RunnerOptions options_;
  JobStore& store_;
  const JobFiles& files_;
  Counters& counters_;
  std::function<bool()> disk_is_writable_;
};

}  // namespace sheaf::server
