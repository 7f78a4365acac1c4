// SPDX-License-Identifier: MIT
// What the routes can do with jobs: submit, look, cancel, remove, watch; and what happens by itself: running, expiry.
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
  std::uint64_t kept_bytes = 0;  // of all jobs: beyond it, ended ones go, the earliest first; 0: no limit
  Limits limits;
  std::size_t jobs_at_once = 1;
  std::size_t most_submissions = 16;  // that are looked into and stored, each on a thread for requests
  std::uint64_t least_free_bytes = std::uint64_t{256} << 20;  // no new job is taken with less disk than this
};

class JobService {
 public:
  JobService(ServiceOptions options, JobStore& store, const JobFiles& files);
  ~JobService();
  JobService(const JobService&) = delete;
  JobService& operator=(const JobService&) = delete;

  /// Throws Problem (503) if no job can be taken now: asked before an upload is read, so that none is read in vain, and
  /// again at its end.
  void check_capacity() const;

  /// To be held from an upload's end until its answer: looking into a scene and syncing it keep a thread waiting, and
  /// a bounded number of them leaves threads for requests that wait for nothing. Throws Problem (503); then the upload
  /// that was received under `job.id` is gone.
  using Place = std::shared_ptr<void>;
  [[nodiscard]] Place take_place(const Job& job);

  /// "ok" or the reason why no job should be sent here. What failed once must be well again by a margin: a service at
  /// its limit does not change its mind with every job.
  struct Fitness {
    std::string disk = "ok", queue = "ok";
  };
  [[nodiscard]] Fitness fitness();

  /// Takes up the jobs of an earlier run. To be called once, before the first request. `fresh`: the store is new, so
  /// that folders it does not know need not be rubbish.
  void recover(bool fresh);

  /// Looks into an upload that was received under `job.id`. Throws Problem (422) if the scene passes a limit; then the
  /// upload is gone.
  void inspect(const Job& job);

  /// Takes an upload that was received under `job.id`. On `repeated` and `conflict` the upload is thrown away.
  Submitted submit(Job job, const Idempotency& idempotency, const std::string& request);

  /// Throws Problem: 404, or 410 for a job that was there.
  [[nodiscard]] Job get(const std::string& id) const;
  [[nodiscard]] std::shared_ptr<EventLog> events(const std::string& id) const;

  /// Asks an unfinished job to stop; a finished one stays as it is. Returns the job as it is now. Throws Problem: 404,
  /// 410.
  Job cancel(const std::string& id);

  /// Unfinished: asks it to stop and returns the job as it is now. Finished, or asked before: removes it and returns
  /// nothing. Throws Problem: 404, 410.
  std::optional<Job> cancel_or_remove(const std::string& id);

  /// Takes no more jobs, lets watchers go, stops the workers.
  void shut_down();

  [[nodiscard]] const JobStore& store() const { return store_; }
  [[nodiscard]] const JobFiles& files() const { return files_; }
  [[nodiscard]] const JobQueue& queue() const { return *queue_; }
  [[nodiscard]] const ServiceOptions& options() const { return options_; }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] bool stopping() const { return stopping_; }

 private:
  void check_room() const;
  [[nodiscard]] std::optional<std::string> disk_trouble();
  bool ask_to_stop(Job& job, NewEvents& events);
  bool take_up(const std::string& id);
  [[noreturn]] void refuse_missing(const std::string& id) const;
  void remove(const std::string& id, const std::string& reason);
  void worker_gone(const std::string& id);
  void remove_expired();

  ServiceOptions options_;
  JobStore& store_;
  const JobFiles& files_;
  Counters counters_;
  JobRunner runner_;
  SceneInspector inspector_;
  std::atomic<std::size_t> places_taken_{0};
  std::atomic<bool> stopping_{false}, queue_was_full_{false}, disk_was_low_{false};
  std::mutex mutex_;
  std::condition_variable stopped_;
  std::unique_ptr<JobQueue> queue_;
  std::thread janitor_;
};

}  // namespace sheaf::server
