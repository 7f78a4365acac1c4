// SPDX-License-Identifier: MIT
#include "jobs/job_service.hpp"

#include <algorithm>

#include "core/quote.hpp"
#include "jobs/frame_collection.hpp"
#include "jobs/outcome.hpp"
#include "util/ids.hpp"
#include "util/log.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr auto janitor_interval = std::chrono::seconds(1);
constexpr std::size_t inspections_at_once = 4;  // each may use as much memory as a worker

[[noreturn]] void refuse_busy() {
  throw Problem(ProblemKind::busy, "too many scenes are being inspected at once").header("Retry-After", "1");
}

}  // namespace

JobService::JobService(ServiceOptions options, JobStore& store, const JobFiles& files)
    : options_(std::move(options)),
      store_(store),
      files_(files),
      runner_(options_.runner, store, files, counters_, [this] { return !disk_error(); }),
      inspector_(options_.runner.sheaf, options_.runner.confinement, options_.limits, inspections_at_once) {
  queue_ = std::make_unique<JobQueue>(runner_, options_.jobs_at_once,
                                      [this](const std::string& id) { on_worker_ended(id); });
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
  inspector_.interrupt();
  store_.interrupt_waits();
  queue_->shut_down();
  if (janitor_.joinable()) janitor_.join();
}

void JobService::check_capacity() const {
  check_room();
  if (admitted_ >= options_.max_submissions) refuse_busy();
}

JobService::AdmissionTicket JobService::admit(const Job& job) {
  const std::size_t others = admitted_++;
  AdmissionTicket ticket(nullptr, [this](std::nullptr_t) { --admitted_; });
  if (others < options_.max_submissions) return ticket;
  files_.remove(job.id);
  refuse_busy();
}

/// Throws Problem (503) unless the queue and the disk have room for a job.
void JobService::check_room() const {
  if (stopping_) throw Problem(ProblemKind::shutting_down, "no new job is accepted").header("Retry-After", "5");
  const std::uint64_t waiting = queue_->waiting();
  if (waiting >= options_.limits.queued_jobs)
    throw Problem(ProblemKind::queue_full, std::to_string(waiting) + " jobs are waiting, the limit is " +
                                               std::to_string(options_.limits.queued_jobs))
        .header("Retry-After", "10")
        .exceeded("max-queue", options_.limits.queued_jobs, waiting);
  if (const auto reason = store_.write_error())
    throw Problem(ProblemKind::storage, *reason).header("Retry-After", "30");
  const std::uint64_t free = files_.free_bytes();
  if (free < options_.min_free_bytes)
    throw Problem(ProblemKind::storage, "the disk has " + std::to_string(free >> 20) +
                                            " MiB free, jobs are accepted from " +
                                            std::to_string(options_.min_free_bytes >> 20) + " MiB on")
        .header("Retry-After", "60")
        .exceeded("min-free", options_.min_free_bytes, free);
}

JobService::Readiness JobService::readiness() {
  Readiness readiness;
  if (stopping_) readiness.queue = "the service is stopping";
  const std::uint64_t waiting = queue_->waiting(), limit = options_.limits.queued_jobs;
  queue_full_ = waiting >= limit || (queue_full_ && waiting + std::max<std::uint64_t>(1, limit / 10) > limit);
  if (queue_full_)
    readiness.queue = std::to_string(waiting) + " jobs are waiting, the limit is " + std::to_string(limit);
  if (const auto reason = disk_error()) readiness.disk = *reason;
  return readiness;
}

/// Why no job should write now; nothing if it may.
std::optional<std::string> JobService::disk_error() {
  if (auto reason = store_.write_error()) return reason;
  if (auto reason = files_.write_error()) return reason;
  const std::uint64_t free = files_.free_bytes(), least = options_.min_free_bytes;
  disk_low_ = free < least || (disk_low_ && free < least + least / 10);
  if (!disk_low_) return std::nullopt;
  return "the disk has " + std::to_string(free >> 20) + " MiB free, jobs are accepted from " +
         std::to_string(least >> 20) + " MiB on";
}

void JobService::recover(bool new_store) {
  if (!new_store)
    files_.remove_orphan_folders([this](const std::string& id) { return store_.presence(id) == Presence::present; });
  std::size_t resumed = 0;
  for (const std::string& id : store_.unfinished()) {
    if (!resume_job(id)) continue;
    queue_->add(id);
    ++resumed;
  }
  if (resumed > 0) write_log(LogLevel::info, "unfinished jobs queued again", {{"jobs", resumed}});
}

/// Whether an unfinished job of an earlier run is to be queued again; one that cannot be rendered is ended.
bool JobService::resume_job(const std::string& id) {
  bool wanted = false;
  const std::optional<Job> job = store_.find(id);
  if (!job) return false;
  std::error_code error;
  const bool whole = std::filesystem::exists(files_.scene(id) / job->scene_file, error);
  const bool attempts_exhausted = job->fruitless_starts >= options_.runner.attempts;
  // Nothing is written: one sync per job would delay a service with a long queue.
  if (job->state == JobState::queued && !job->cancel_requested && whole && !attempts_exhausted) return true;
  const std::chrono::seconds retention = options_.runner.retention;
  store_.update(id, [&](Job& stored, NewEvents& events) {
    if (stored.cancel_requested) return finish_job(stored, events, JobState::cancelled, std::nullopt, retention);
    if (!whole) return finish_job(stored, events, JobState::failed, outcome_of_lost_files().failure, retention);
    if (attempts_exhausted)
      return finish_job(stored, events, JobState::failed, outcome_of_too_many_starts(stored.fruitless_starts).failure,
                        retention);
    wanted = true;
    if (stored.state == JobState::running) requeue_job(stored, events);
  });
  return wanted;
}

void JobService::inspect(const Job& job) {
  try {
    const std::filesystem::path folder = files_.incoming(job.id);
    inspector_.check(folder, folder / "scene" / job.scene_file, job.arguments);
  } catch (...) {
    files_.remove(job.id);
    throw;
  }
}

Submitted JobService::submit(Job job, const Idempotency& idempotency, const std::string& request) {
  const std::string id = job.id;
  Submitted submitted;
  try {
    check_room();
    files_.accept(id);
    submitted = store_.insert(std::move(job), idempotency);
  } catch (...) {
    files_.remove(id);
    throw;
  }
  if (submitted.kind != Submitted::Kind::created) {
    files_.remove(id);
    return submitted;
  }
  ++counters_.jobs_accepted;
  queue_->add(id);
  write_log(LogLevel::info, "job accepted", {{"job", id}, {"request", request}});
  return submitted;
}

void JobService::refuse_missing(const std::string& id) const {
  if (store_.presence(id) == Presence::removed)
    throw Problem(ProblemKind::job_removed, "job " + id + " " + store_.removal_reason(id));
  throw Problem(ProblemKind::unknown_job, "there is no job '" + quote(id) + "'");
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

/// False if the job was asked to stop before.
bool JobService::ask_to_stop(Job& job, NewEvents& events) {
  if (job.cancel_requested) return false;
  job.cancel_requested = true;
  if (job.state == JobState::queued) {
    finish_job(job, events, JobState::cancelled, std::nullopt, options_.runner.retention);
    counters_.ended(JobState::cancelled);
  }
  return true;
}

Job JobService::cancel(const std::string& id) {
  const bool there = store_.update(
      id, [&](Job& job, NewEvents& events) { ask_to_stop(job, events); }, OnWriteError::refuse);
  if (there) {
    queue_->forget(id);
    queue_->stop_worker(id, false);
  }
  return get(id);
}

std::optional<Job> JobService::cancel_or_remove(const std::string& id) {
  bool asked = false;
  std::optional<Job> job;
  store_.update(
      id,
      [&](Job& stored, NewEvents& events) {
        asked = ask_to_stop(stored, events);
        job = stored;
      },
      OnWriteError::refuse);
  if (!asked) {
    remove(id, "was removed");
    return std::nullopt;
  }
  queue_->forget(id);
  queue_->stop_worker(id, false);
  return job;
}

/// The files of a job whose worker still runs are removed when the worker has ended.
void JobService::remove(const std::string& id, const std::string& reason) {
  if (!store_.remove(id, reason)) refuse_missing(id);
  queue_->forget(id);
  queue_->stop_worker(id, true);
  if (!queue_->is_running(id)) files_.remove(id);
  write_log(LogLevel::info, "job removed", {{"job", id}, {"reason", reason}});
}

void JobService::on_worker_ended(const std::string& id) {
  if (store_.presence(id) != Presence::present) files_.remove(id);
}

void JobService::remove_expired() {
  const auto remove_all = [this](const std::vector<std::string>& ids, const std::string& reason) {
    for (const std::string& id : ids) {
      try {
        remove(id, reason);
      } catch (const Problem&) {
        // A client removed it first.
      }
    }
  };
  try {
    (void)store_.write_error();  // writes what could not be written before
    remove_all(store_.expired(std::chrono::system_clock::now()), "has expired");
    if (options_.kept_bytes > 0)
      remove_all(store_.over_quota(options_.kept_bytes), "was removed to make room for others");
  } catch (const std::exception& error) {
    write_log(LogLevel::error, "cannot remove expired jobs", {{"reason", error.what()}});
  }
}

}  // namespace sheaf::server
