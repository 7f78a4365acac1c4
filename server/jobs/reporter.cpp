// SPDX-License-Identifier: MIT
#include "jobs/reporter.hpp"

#include "jobs/job_change.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t max_warnings = 200;
constexpr std::uint64_t max_ignored_lines = 100;  // so many lines that are no events are logged

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;  // clang before 17 does not find it by itself

StoredFilePtr shared(std::optional<StoredFile> file) {
  return file ? std::make_shared<const StoredFile>(*std::move(file)) : nullptr;
}

}  // namespace

void Reporter::line(std::string_view text) {
  const std::optional<WorkerEvent> event = parse_worker_event(text);
  if (!event) {
    if (++ignored_lines_ <= max_ignored_lines) log_.line("not an event: " + std::string(text.substr(0, 200)));
    return;
  }
  std::visit(
      Overloaded{[this](const StartEvent& e) { started(e); }, [this](const FrameEvent& e) { rendered(e); },
                 [this](const WarningEvent& e) { warned(e.message); },
                 [this](const ErrorEvent& e) { error_ = log_.without_paths(e.message); }, [](const DoneEvent&) {}},
      *event);
}

/// The worker counts the frames that it will render, without those of an earlier attempt.
void Reporter::started(const StartEvent& event) {
  store_.update(id_, [&](Job& job, NewEvents& events) {
    if (!job.frames_known) job.total = job.frames_done + event.frames;
    events.append("start", {{"frames", job.total.value_or(event.frames)}});
  });
}

void Reporter::rendered(const FrameEvent& event) {
  const auto path = files_.frames(id_) / event.file;
  Frame frame{event.frame, shared(stored_file(path)),
              shared(stored_file(std::filesystem::path(path).replace_extension(".png"))), event.wall_ms};
  if (!frame.exr || !event.file.ends_with(".exr"))
    return log_.line("frame " + std::to_string(event.frame) + " was reported, but " + event.file + " is missing");
  store_.update(id_, [&](Job& job, NewEvents& events) {
    if (job.frames_known && !find_frame(job.frames, event.frame))
      return log_.line("frame " + std::to_string(event.frame) + " was not asked for");
    job.eta_s = event.eta_s;
    job.fruitless_starts = 0;
    if (put_frame(job, frame, events)) ++counters_.frames_rendered;
  });
}

void Reporter::warned(const std::string& message) {
  const std::string text = log_.without_paths(message).substr(0, 2000);
  store_.update(id_, [&](Job& job, NewEvents& events) {
    if (job.warnings.size() >= max_warnings) return;
    job.warnings.push_back(text);
    events.append("warning", {{"message", text}});
  });
}

}  // namespace sheaf::server
