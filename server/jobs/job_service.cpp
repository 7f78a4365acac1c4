// SPDX-License-Identifier: MIT
#include "jobs/job_service.hpp"

#include "http/problem.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

constexpr auto janitor_interval = std::chrono::seconds(1);

}  // namespace

JobService::JobService(ServiceOptions options, JobStore& store, const JobFiles& files)
    : options_(std::move(options)), store_(store), files_(files), runner_(options_.runner, store, files, counters_) {
  queue_ =
      std::make_unique<JobQueue>(runner_, options_.jobs_at_once, [this](const std::string& id) { worker_gone(id); });
  janitor_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    while (!stopped_.wait_for(lock, janitor_interval, [this] { return stopping_.load(); })) {
      lock.unlock();
      remove_expired();
      lock.lock();
    }
  });
}

JobService::~JobService() { shut_down(); }

void JobService::shut_down() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
  store_.interrupt_waits();
  queue_->shut_down();
  if (janitor_.joinable()) janitor_.join();
}

void JobService::check_capacity() const {
  if (stopping_) throw Problem(ProblemKind::shutting_down, "no new job is taken").header("Retry-After", "5");
  const std::uint64_t waiting = queue_->waiting();
  if (waiting >= options_.limits.queued_jobs)
    throw Problem(ProblemKind::queue_full, std::to_string(waiting) + " jobs are waiting, the limit is " +
                                               std::to_string(options_.limits.queued_jobs))
        .header("Retry-After", "10")
        .member("limit", options_.limits.queued_jobs)
        .member("value", waiting);
  const std::uint64_t free = files_.free_bytes();
  if (free < options_.least_free_bytes)
    throw Problem(ProblemKind::storage, "the disk has " + std::to_string(free >> 20) +
                                            " MiB left, jobs are taken from " +
                                            std::to_string(options_.least_free_bytes >> 20) + " MiB on")
        .header("Retry-After", "60");
}

Submitted JobService::submit(Job job, const Idempotency& idempotency) {
  check_capacity();
  const std::string id = job.id;
  files_.accept(id);
  const Submitted submitted = store_.insert(std::move(job), idempotency);
  if (submitted.kind != Submitted::Kind::created) {
    files_.remove(id);
    return submitted;
  }
  ++counters_.jobs_accepted;
  queue_->add(id);
  write_log(LogLevel::info, "job accepted", {{"job", id}});
  return submitted;
}

void JobService::refuse_missing(const std::string& id) const {
  if (store_.presence(id) == Presence::removed)
    throw Problem(ProblemKind::job_removed, "job " + id + " was removed or has expired");
  throw Problem(ProblemKind::unknown_job, "there is no job '" + id + "'");
}

Job JobService::get(const std::string& id) const {
  std::optional<Job> job = store_.find(id);
  if (!job) refuse_missing(id);
  return *std::move(job);
}

std::shared_ptr<EventLog> JobService::events(const std::string& id) const {
  auto events = store_.events(id);
  if (!events) refuse_missing(id);
  return events;
}

/// False if there is nothing to be done: the job has ended, or was asked before.
bool JobService::ask_to_stop(Job& job, EventLog& events) {
  if (is_finished(job.state) || job.cancel_requested) return false;
  job.cancel_requested = true;
  if (job.state == JobState::queued) {
    finish_job(job, events, JobState::cancelled, std::nullopt, options_.runner.retention);
    counters_.ended(JobState::cancelled);
  }
  return true;
}

Job JobService::cancel(const std::string& id) {
  std::optional<Job> found;
  store_.update(id, [&](Job& job, EventLog& events) {
    ask_to_stop(job, events);
    found = job;
  });
  if (!found) refuse_missing(id);
  if (found->cancel_requested) {
    queue_->forget(id);
    queue_->stop_worker(id, false);
  }
  return *std::move(found);
}

std::optional<Job> JobService::cancel_or_remove(const std::string& id) {
  std::optional<Job> cancelled;
  const bool there = store_.update(id, [&](Job& job, EventLog& events) {
    if (ask_to_stop(job, events)) cancelled = job;
  });
  if (!there) refuse_missing(id);
  if (!cancelled) {
    remove(id);
    return std::nullopt;
  }
  queue_->forget(id);
  queue_->stop_worker(id, false);
  return cancelled;
}

/// The files of a job whose worker still runs go when the worker has gone.
void JobService::remove(const std::string& id) {
  if (!store_.remove(id)) refuse_missing(id);
  queue_->stop_worker(id, true);
  if (!queue_->is_running(id)) files_.remove(id);
  write_log(LogLevel::info, "job removed", {{"job", id}});
}

void JobService::worker_gone(const std::string& id) {
  if (store_.presence(id) != Presence::present) files_.remove(id);
}

void JobService::remove_expired() {
  for (const std::string& id : store_.expired(std::chrono::system_clock::now())) {
    try {
      remove(id);
    } catch (const Problem&) {
      // A client removed it first.
    }
  }
}

}  // namespace sheaf::server
