// SPDX-License-Identifier: MIT
// What the routes can do with jobs (submit, read, cancel, remove, watch) and what happens without them (running,
// expiry).
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "jobs/job_files.hpp"
#include "jobs/job_queue.hpp"
#include "jobs/job_runner.hpp"
#include "jobs/job_store.hpp"
#include "jobs/limits.hpp"
#include "jobs/scene_inspector.hpp"

namespace sheaf::server {

struct ServiceOptions {
  RunnerOptions runner;
  std::uint64_t kept_bytes = 0;  // of all jobs: above it, the jobs that ended first are removed; 0: no limit
  Limits limits;
  std::size_t jobs_at_once = 1;
  std::size_t max_submissions = 16;  // being inspected and stored at once, each on an HTTP thread
  std::uint64_t min_free_bytes = std::uint64_t{256} << 20;  // with less free disk no job is accepted
};

class JobService {
 public:
  JobService(ServiceOptions options, JobStore& store, const JobFiles& files);
  ~JobService();
  JobService(const JobService&) = delete;
  JobService& operator=(const JobService&) = delete;

  /// Throws Problem (503) if no job can be accepted now. Called before an upload is read, so that none is read in vain,
  /// and again at its end.
  void check_capacity() const;

  /// Held from an upload's end until its answer. Inspecting and syncing a scene block a thread; a bounded number of
  /// tickets leaves threads for requests that do not block. Throws Problem (503); then the upload that was received
  /// under `job.id` is removed.
  using AdmissionTicket = std::shared_ptr<void>;
  [[nodiscard]] AdmissionTicket admit(const Job& job);

  /// "ok" or the reason why no job should be sent here. After a failure, "ok" needs a margin, so that the answer of a
  /// service at its limit does not change with every job (hysteresis).
  struct Readiness {
    std::string disk = "ok", queue = "ok";
  };
  [[nodiscard]] Readiness readiness();

  /// Queues the unfinished jobs of an earlier run. To be called once, before the first request. With a new store (whose
  /// database may have been lost) folders that it does not know are kept.
  void recover(bool new_store);

  /// Inspects an upload that was received under `job.id`. Throws Problem (422) if the scene exceeds a limit; then the
  /// upload is removed.
  void inspect(const Job& job);

  /// Accepts an upload that was received under `job.id`. On `repeated` and `conflict` the upload is removed.
  Submitted submit(Job job, const Idempotency& idempotency, const std::string& request);

  /// Throws Problem: 404, or 410 for a job that was removed.
  [[nodiscard]] Job get(const std::string& id) const;
  [[nodiscard]] std::shared_ptr<EventLog> events(const std::string& id) const;

  /// Asks an unfinished job to stop; a finished one stays as it is. Returns the job as it is now. Throws Problem: 404,
  /// 410.
  Job cancel(const std::string& id);

  /// Unfinished: asks it to stop and returns the job as it is now. Finished, or asked before: removes it and returns
  /// nothing. Throws Problem: 404, 410.
  std::optional<Job> cancel_or_remove(const std::string& id);

  /// Accepts no more jobs, ends event streams, stops the workers.
  void shut_down();

  [[nodiscard]] const JobStore& store() const { return store_; }
  [[nodiscard]] const JobFiles& files() const { return files_; }
  [[nodiscard]] const JobQueue& queue() const { return *queue_; }
  [[nodiscard]] const ServiceOptions& options() const { return options_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] bool stopping() const { return stopping_; }

 private:
  void check_room() const;
  [[nodiscard]] std::optional<std::string> disk_error();
  bool ask_to_stop(Job& job, NewEvents& events);
  bool resume_job(const std::string& id);
  [[noreturn]] void refuse_missing(const std::string& id) const;
  void remove(const std::string& id, const std::string& reason);
  void on_worker_ended(const std::string& id);
  void remove_expired();

  ServiceOptions options_;
  JobStore& store_;
  const JobFiles& files_;
  Counters counters_;
  JobRunner runner_;
  SceneInspector inspector_;
  std::atomic<std::size_t> admitted_{0};
  std::atomic<bool> stopping_{false}, queue_full_{false}, disk_low_{false};
  std::mutex mutex_;
  std::condition_variable stopped_;
  std::unique_ptr<JobQueue> queue_;
  std::thread janitor_;
};

}  // namespace sheaf::server
