// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "jobs/job_runner.hpp"

namespace sheaf::server {

/// First come, first served, so many jobs at once. What runs can be stopped by its job's id.
class JobQueue {
 public:
  /// `ended` is called after a job's worker is gone, whatever became of the job.
  JobQueue(const JobRunner& runner, std::size_t at_once, std::function<void(const std::string& id)> ended);
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  void add(const std::string& id);
  void forget(const std::string& id);  // if it still waits

  /// Asks the job's worker to stop, or forces it; nothing happens if it has none.
  void stop_worker(const std::string& id, bool force);

  [[nodiscard]] bool is_running(const std::string& id) const;
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::string next() const;  // to be run; empty if none waits
  [[nodiscard]] std::size_t at_once() const { return threads_.size(); }

  /// Starts nothing more, stops every worker, returns when they are gone.
  void shut_down();

 private:
  void work();

  const JobRunner& runner_;
  std::function<void(const std::string& id)> ended_;
  mutable std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<std::string> waiting_;
  std::map<std::string, std::shared_ptr<StopSwitch>> running_;
  bool closed_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace sheaf::server
