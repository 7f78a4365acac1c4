// SPDX-License-Identifier: MIT
#include "jobs/job_runner.hpp"

#include <poll.h>

#include "core/error.hpp"
#include "jobs/frame_collection.hpp"
#include "jobs/outcome.hpp"
#include "jobs/reporter.hpp"
#include "jobs/worker_log.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

std::uint64_t missing_frames(const Job& job) {
  const std::uint64_t wanted = job.total.value_or(1);  // without a start event at least one frame is expected
  return wanted > job.frames_done ? wanted - job.frames_done : 0;
}

constexpr auto disk_interval = std::chrono::seconds(1);

}  // namespace

std::vector<std::string> JobRunner::command_of(const Job& job) const {
  std::vector<std::string> command{options_.sheaf, "render", (files_.scene(job.id) / job.scene_file).string()};
  if (job.has_camera) command.push_back("--camera=" + files_.camera(job.id).string());
  command.insert(command.end(), {"--out", files_.frames(job.id).string(), "--stats", files_.stats(job.id).string(),
                                 "--progress", "json"});
  if (job.starts > 1) command.emplace_back("--resume");
  command.insert(command.end(), job.arguments.begin(), job.arguments.end());
  return command;
}

void JobRunner::run(const std::string& id, const StopSwitch& stop) const noexcept {
  try {
    for (bool again = false;; again = true) {
      const std::optional<Job> job = begin(id, again);
      if (!job) return;
      const Next next = attempt(*job, stop);
      if (next == Next::ended || next == Next::queued) return;
      if (next == Next::when_disk_is_writable && !wait_for_disk(stop)) return;
    }
  } catch (const std::exception& error) {
    write_log(LogLevel::error, "job failed", {{"job", id}, {"reason", error.what()}});
    conclude(id, outcome_of_no_start(error.what()));
  }
}

/// The start is counted beforehand, so that a job that brings the whole service down is not tried for ever.
std::optional<Job> JobRunner::begin(const std::string& id, bool again) const {
  std::optional<Job> job;
  store_.update(id, [&](Job& stored, NewEvents& events) {
    if (!again && stored.state != JobState::queued) return;
    if (stored.state == JobState::queued) events.append("state", {{"state", "running"}});
    stored.state = JobState::running;
    if (!stored.started) stored.started = std::chrono::system_clock::now();
    ++stored.starts;
    ++stored.fruitless_starts;
    job = stored;
  });
  return job;
}

Ending JobRunner::run_worker_of(const Job& job, const StopSwitch& stop) const {
  Ending ending;
  WorkerLog log(files_.log(job.id), options_.log_bytes, files_.folder(job.id).string());
  Reporter reporter(job.id, store_, files_, counters_, log);
  const WorkerOutput output{[&](std::string_view line) { reporter.line(line); },
                            [&](std::string_view bytes) { log.append(bytes); }};
  const Confinement confinement(options_.confinement, options_.sheaf, files_.folder(job.id));
  ending.worker =
      run_worker(command_of(job), output, stop, {options_.grace, options_.wall, &confinement, options_.cancel_grace});
  ending.wall = options_.wall;
  ending.cpu_seconds = options_.confinement.cpu_seconds;
  log.end();
  ending.message = reporter.error().empty() ? log.last_line() : reporter.error();
  return ending;
}

/// False if the job is to be stopped first.
bool JobRunner::wait_for_disk(const StopSwitch& stop) const {
  pollfd switched{stop.fd(), POLLIN, 0};
  while (!stop.asked() && !disk_is_writable_())
    ::poll(&switched, 1, static_cast<int>(std::chrono::milliseconds(disk_interval).count()));
  return !stop.asked();
}

JobRunner::Next JobRunner::attempt(const Job& job, const StopSwitch& stop) const {
  write_log(LogLevel::info, "job started", {{"job", job.id}, {"start", job.starts}});
  if (job.starts > 1) verify_frames(store_, files_, job.id);
  ++counters_.worker_starts;
  Ending ending = run_worker_of(job, stop);
  if (ending.worker.exit_code == exit_no_device) ++counters_.devices_missed;
  counters_.work.add(files_.stats(job.id));
  if (ending.worker.exit_code != 0) adopt_frames(store_, files_, job.id);

  const bool full = ending.worker.exit_code == exit_storage && !disk_is_writable_();
  // Read in the same step as the state changes: a client may ask to cancel until then.
  Outcome outcome;
  Next next = Next::ended;
  const bool there = store_.update(job.id, [&](Job& stored, NewEvents& events) {
    ending.cancel_requested = stored.cancel_requested;
    ending.missing = missing_frames(stored);
    outcome = outcome_of(ending);
    if (outcome.state == JobState::failed && (stop.asked() || full)) {  // the service stops, or the disk is full
      next = stop.asked() ? Next::queued : Next::when_disk_is_writable;
      if (full)
        events.append("warning",
                      {{"message", outcome.failure->message + "; it continues when the disk can be written"}});
      if (stored.fruitless_starts > 0) --stored.fruitless_starts;
      return requeue_job(stored, events);
    }
    if (outcome.state == JobState::failed && is_transient(ending) && stored.fruitless_starts < options_.attempts) {
      next = Next::again;
      events.append("warning", {{"message", outcome.failure->message + "; it is started again"}});
      return;
    }
    finish_job(stored, events, outcome.state, outcome.failure, options_.retention);
  });
  if (!there) return Next::ended;  // removed meanwhile
  if (next == Next::again || next == Next::when_disk_is_writable) ++counters_.workers_tried_again;
  if (next == Next::ended) counters_.ended(outcome.state);
  const char* const state = next == Next::ended ? name_of(outcome.state) : next == Next::again ? "running" : "queued";
  write_log(LogLevel::info, "worker ended",
            {{"job", job.id}, {"state", state}, {"reason", outcome.failure ? outcome.failure->message : ""}});
  return next;
}

void JobRunner::conclude(const std::string& id, const Outcome& outcome) const {
  const bool there = store_.update(id, [&](Job& job, NewEvents& events) {
    finish_job(job, events, outcome.state, outcome.failure, options_.retention);
  });
  if (there) counters_.ended(outcome.state);
}

}  // namespace sheaf::server
