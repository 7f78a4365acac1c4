// SPDX-License-Identifier: MIT
#include "jobs/job_runner.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "jobs/outcome.hpp"
#include "jobs/worker_events.hpp"
#include "jobs/worker_log.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_warnings = 1000;
constexpr std::uint64_t max_odd_lines = 100;  // kept of what a worker prints that is no event

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};

/// A worker's lines on their way into the job.
class Reporter {
 public:
  Reporter(const std::string& id, JobStore& store, const JobFiles& files, Counters& counters, WorkerLog& log)
      : id_(id), store_(store), files_(files), counters_(counters), log_(log) {}

  void line(std::string_view text) {
    const std::optional<WorkerEvent> event = parse_worker_event(text);
    if (!event) {
      if (++odd_lines_ <= max_odd_lines) log_.line("not an event: " + std::string(text.substr(0, 200)));
      return;
    }
    std::visit(
        Overloaded{[this](const StartEvent& e) { started(e); }, [this](const FrameEvent& e) { rendered(e); },
                   [this](const WarningEvent& e) { warned(e.message); },
                   [this](const ErrorEvent& e) { error_ = log_.without_paths(e.message); }, [](const DoneEvent&) {}},
        *event);
  }

  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void started(const StartEvent& event) {
    store_.update(id_, [&](Job& job, EventLog& events) {
      if (!job.frames_known) job.total = event.frames;
      events.append("start", {{"frames", job.total.value_or(event.frames)}});
    });
  }

  void rendered(const FrameEvent& event) {
    const auto path = files_.frames(id_) / event.file;
    std::optional<StoredFile> exr = stored_file(path);
    std::optional<StoredFile> png = stored_file(std::filesystem::path(path).replace_extension(".png"));
    if (!exr || !event.file.ends_with(".exr"))
      return log_.line("frame " + std::to_string(event.frame) + " was reported, but " + event.file + " is not there");
    store_.update(id_, [&](Job& job, EventLog& events) {
      Frame* frame = find_frame(job.frames, event.frame);
      if (!frame && job.frames_known) return log_.line("frame " + std::to_string(event.frame) + " was not asked for");
      if (!frame) {
        const auto at = std::ranges::lower_bound(job.frames, event.frame, {}, &Frame::number);
        frame = &*job.frames.insert(at, Frame{event.frame, {}, {}, 0});
      }
      if (!frame->exr) ++job.frames_done, ++counters_.frames_rendered;
      frame->exr = std::move(exr);
      frame->png = std::move(png);
      frame->wall_ms = event.wall_ms;
      job.eta_s = event.eta_s;
      announce(job, *frame, events);
    });
  }

  static void announce(const Job& job, const Frame& frame, EventLog& events) {
    nlohmann::ordered_json data{{"frame", frame.number},
                                {"done", job.frames_done},
                                {"total", job.total ? nlohmann::ordered_json(*job.total) : nullptr},
                                {"eta_s", job.eta_s ? nlohmann::ordered_json(*job.eta_s) : nullptr},
                                {"wall_ms", frame.wall_ms},
                                {"bytes", frame.exr->bytes},
                                {"sha256", frame.exr->sha256},
                                {"preview", frame.png.has_value()}};
    events.append("frame", std::move(data));
  }

  void warned(const std::string& message) {
    const std::string text = log_.without_paths(message).substr(0, 2000);
    store_.update(id_, [&](Job& job, EventLog& events) {
      if (job.warnings.size() >= max_warnings) return;
      job.warnings.push_back(text);
      events.append("warning", {{"message", text}});
    });
  }

  const std::string& id_;
  JobStore& store_;
  const JobFiles& files_;
  Counters& counters_;
  WorkerLog& log_;
  std::string error_;
  std::uint64_t odd_lines_ = 0;
};

std::uint64_t missing_frames(const Job& job) {
  const std::uint64_t wanted = job.total.value_or(1);  // a worker that never said how many has made one at least
  return wanted > job.frames_done ? wanted - job.frames_done : 0;
}

}  // namespace

void finish_job(Job& job, EventLog& events, JobState state, std::optional<Failure> failure,
                std::chrono::seconds retention) {
  job.state = state;
  job.finished = std::chrono::system_clock::now();
  if (retention.count() > 0) job.expires = *job.finished + retention;
  job.eta_s.reset();
  job.error = std::move(failure);
  nlohmann::ordered_json data{{"state", name_of(state)}};
  if (job.error) data["error"] = failure_to_json(*job.error);
  events.append("state", std::move(data));
  events.close();
}

std::vector<std::string> JobRunner::command_of(const Job& job) const {
  std::vector<std::string> command{options_.sheaf, "render", (files_.scene(job.id) / job.scene_file).string()};
  if (job.has_camera) command.push_back("--camera=" + files_.camera(job.id).string());
  command.insert(command.end(), {"--out", files_.frames(job.id).string(), "--stats", files_.stats(job.id).string(),
                                 "--progress", "json"});
  command.insert(command.end(), job.arguments.begin(), job.arguments.end());
  return command;
}

void JobRunner::run(const std::string& id, const StopSwitch& stop) const noexcept {
  try {
    std::optional<Job> job;
    store_.update(id, [&](Job& stored, EventLog& events) {
      if (stored.state != JobState::queued) return;
      stored.state = JobState::running;
      stored.started = std::chrono::system_clock::now();
      events.append("state", {{"state", "running"}});
      job = stored;
    });
    if (job) run_started(*job, stop);
  } catch (const std::exception& error) {
    write_log(LogLevel::error, "job failed", {{"job", id}, {"reason", error.what()}});
    conclude(id, outcome_of_no_start(error.what()));
  }
}

void JobRunner::run_started(const Job& job, const StopSwitch& stop) const {
  write_log(LogLevel::info, "job started", {{"job", job.id}});
  Ending ending;
  {
    WorkerLog log(files_.log(job.id), options_.log_bytes, files_.folder(job.id).string());
    Reporter reporter(job.id, store_, files_, counters_, log);
    const WorkerOutput output{[&](std::string_view line) { reporter.line(line); },
                              [&](std::string_view bytes) { log.append(bytes); }};
    ending.worker = run_worker(command_of(job), output, stop, options_.grace);
    log.end();
    ending.message = reporter.error().empty() ? log.last_line() : reporter.error();
  }
  // Read last: a client may have asked to cancel until now.
  Outcome outcome;
  store_.update(job.id, [&](Job& stored, EventLog& events) {
    ending.cancel_requested = stored.cancel_requested;
    ending.missing = missing_frames(stored);
    outcome = outcome_of(ending);
    finish_job(stored, events, outcome.state, outcome.failure, options_.retention);
  });
  counters_.ended(outcome.state);
  write_log(LogLevel::info, "job ended", {{"job", job.id}, {"state", name_of(outcome.state)}});
}

void JobRunner::conclude(const std::string& id, const Outcome& outcome) const {
  counters_.ended(outcome.state);
  store_.update(id, [&](Job& job, EventLog& events) {
    finish_job(job, events, outcome.state, outcome.failure, options_.retention);
  });
}

}  // namespace sheaf::server
