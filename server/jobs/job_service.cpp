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
constexpr std::size_t inspections_at_once = 4;  // each may take a worker's memory

[[noreturn]] void refuse_busy() {
  throw Problem(ProblemKind::busy, "many scenes are being looked into already").header("Retry-After", "1");
}

}  // namespace

JobService::JobService(ServiceOptions options, JobStore& store, const JobFiles& files)
    : options_(std::move(options)),
      store_(store),
      files_(files),
      runner_(options_.runner, store, files, counters_, [this] { return !disk_trouble(); }),
      inspector_(options_.runner.sheaf, options_.runner.confinement, options_.limits, inspections_at_once) {
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
  inspector_.interrupt();
  store_.interrupt_waits();
  queue_->shut_down();
  if (janitor_.joinable()) janitor_.join();
}

void JobService::check_capacity() const {
  check_room();
  if (places_taken_ >= options_.most_submissions) refuse_busy();
}

JobService::Place JobService::take_place(const Job& job) {
  const std::size_t others = places_taken_++;
  Place place(nullptr, [this](std::nullptr_t) { --places_taken_; });
  if (others < options_.most_submissions) return place;
  files_.remove(job.id);
  refuse_busy();
}

/// Whether the queue and the disk have room for a job.
void JobService::check_room() const {
  if (stopping_) throw Problem(ProblemKind::shutting_down, "no new job is taken").header("Retry-After", "5");
  const std::uint64_t waiting = queue_->waiting();
  if (waiting >= options_.limits.queued_jobs)
    throw Problem(ProblemKind::queue_full, std::to_string(waiting) + " jobs are waiting, the limit is " +
                                               std::to_string(options_.limits.queued_jobs))
        .header("Retry-After", "10")
        .passed("max-queue", options_.limits.queued_jobs, waiting);
  if (const auto trouble = store_.trouble()) throw Problem(ProblemKind::storage, *trouble).header("Retry-After", "30");
  const std::uint64_t free = files_.free_bytes();
  if (free < options_.least_free_bytes)
    throw Problem(ProblemKind::storage, "the disk has " + std::to_string(free >> 20) +
                                            " MiB left, jobs are taken from " +
                                            std::to_string(options_.least_free_bytes >> 20) + " MiB on")
        .header("Retry-After", "60")
        .passed("min-free", options_.least_free_bytes, free);
}

JobService::Fitness JobService::fitness() {
  Fitness fitness;
  if (stopping_) fitness.queue = "the service is stopping";
  const std::uint64_t waiting = queue_->waiting(), limit = options_.limits.queued_jobs;
  queue_was_full_ = waiting >= limit || (queue_was_full_ && waiting + std::max<std::uint64_t>(1, limit / 10) > limit);
  if (queue_was_full_)
    fitness.queue = std::to_string(waiting) + " jobs are waiting, the limit is " + std::to_string(limit);
  if (const auto trouble = disk_trouble()) fitness.disk = *trouble;
  return fitness;
}

/// Why nothing should be written now; nothing if it can be.
std::optional<std::string> JobService::disk_trouble() {
  if (auto trouble = store_.trouble()) return trouble;
  if (auto trouble = files_.write_trouble()) return trouble;
  const std::uint64_t free = files_.free_bytes(), least = options_.least_free_bytes;
  disk_was_low_ = free < least || (disk_was_low_ && free < least + least / 10);
  if (!disk_was_low_) return std::nullopt;
  return "the disk has " + std::to_string(free >> 20) + " MiB left, jobs are taken from " +
         std::to_string(least >> 20) + " MiB on";
}

void JobService::recover(bool fresh) {
  if (!fresh)
    files_.remove_strangers([this](const std::string& id) { return store_.presence(id) == Presence::present; });
  std::size_t taken_up = 0;
  for (const std::string& id : store_.unfinished()) {
    if (!take_up(id)) continue;
    queue_->add(id);
    ++taken_up;
  }
  if (taken_up > 0) write_log(LogLevel::info, "jobs taken up", {{"jobs", taken_up}});
}

/// A job of an earlier run: back into the queue if it can still be rendered.
bool JobService::take_up(const std::string& id) {
  bool wanted = false;
  const std::optional<Job> job = store_.find(id);
  if (!job) return false;
  std::error_code error;
  const bool whole = std::filesystem::exists(files_.scene(id) / job->scene_file, error);
  const bool tired = job->fruitless_starts >= options_.runner.attempts;
  // Nothing to be written: a sync for each would keep a service with a long queue from answering.
  if (job->state == JobState::queued && !job->cancel_requested && whole && !tired) return true;
  const std::chrono::seconds retention = options_.runner.retention;
  store_.update(id, [&](Job& stored, NewEvents& events) {
    if (stored.cancel_requested) return finish_job(stored, events, JobState::cancelled, std::nullopt, retention);
    if (!whole) return finish_job(stored, events, JobState::failed, outcome_of_lost_files().failure, retention);
    if (tired)
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

/// False if there is nothing to be done: the job has ended, or was asked before.
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
      id, [&](Job& job, NewEvents& events) { ask_to_stop(job, events); }, IfUnstored::refuse);
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
      IfUnstored::refuse);
  if (!asked) {
    remove(id, "was removed");
    return std::nullopt;
  }
  queue_->forget(id);
  queue_->stop_worker(id, false);
  return job;
}

/// The files of a job whose worker still runs go when the worker has gone.
void JobService::remove(const std::string& id, const std::string& reason) {
  if (!store_.remove(id, reason)) refuse_missing(id);
  queue_->forget(id);
  queue_->stop_worker(id, true);
  if (!queue_->is_running(id)) files_.remove(id);
  write_log(LogLevel::info, "job removed", {{"job", id}, {"reason", reason}});
}

void JobService::worker_gone(const std::string& id) {
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
    (void)store_.trouble();  // stores what could not be stored
    remove_all(store_.expired(std::chrono::system_clock::now()), "has expired");
    if (options_.kept_bytes > 0) remove_all(store_.beyond(options_.kept_bytes), "was removed to make room for others");
  } catch (const std::exception& error) {
    write_log(LogLevel::error, "cannot remove expired jobs", {{"reason", error.what()}});
  }
}

}  // namespace sheaf::server
