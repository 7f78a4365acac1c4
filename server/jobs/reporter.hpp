// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "jobs/counters.hpp"
#include "jobs/job_files.hpp"
#include "jobs/job_store.hpp"
#include "jobs/worker_events.hpp"
#include "jobs/worker_log.hpp"

namespace sheaf::server {

/// Turns a worker's lines into changes of its job.
class Reporter {
 public:
  Reporter(const std::string& id, JobStore& store, const JobFiles& files, Counters& counters, WorkerLog& log)
      : id_(id), store_(store), files_(files), counters_(counters), log_(log) {}

  void line(std::string_view text);

  /// The message of the worker's error event; empty if there was none.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void started(const StartEvent& event);
  void rendered(const FrameEvent& event);
  void warned(const std::string& message);

  const std::string& id_;
  JobStore& store_;
  const JobFiles& files_;
  Counters& counters_;
  WorkerLog& log_;
  std::string error_;
  std::uint64_t ignored_lines_ = 0;
};

}  // namespace sheaf::server
