// SPDX-License-Identifier: MIT
#include "jobs/job_change.hpp"

#include <algorithm>

namespace sheaf::server {
namespace {

using Json = nlohmann::ordered_json;

void announce(const Job& job, const Frame& frame, NewEvents& events) {
  events.append("frame", {{"frame", frame.number},
                          {"done", job.frames_done},
                          {"total", job.total ? Json(*job.total) : Json(nullptr)},
                          {"eta_s", job.eta_s ? Json(*job.eta_s) : Json(nullptr)},
                          {"wall_ms", frame.wall_ms},
                          {"bytes", frame.exr->bytes},
                          {"sha256", frame.exr->sha256},
                          {"preview", frame.png != nullptr}});
}

}  // namespace

bool put_frame(Job& job, const Frame& frame, NewEvents& events) {
  Frame* place = find_frame(job.frames, frame.number);
  if (!place) {
    const auto at = std::ranges::lower_bound(job.frames, frame.number, {}, &Frame::number);
    place = &*job.frames.insert(at, Frame{frame.number, {}, {}, 0});
  }
  const bool fresh = !place->exr;
  if (fresh) ++job.frames_done;
  *place = frame;
  announce(job, frame, events);
  return fresh;
}

void drop_frame(Job& job, std::int64_t number) {
  Frame* const frame = find_frame(job.frames, number);
  if (!frame || !frame->exr) return;
  --job.frames_done;
  if (job.frames_known)
    *frame = Frame{number, {}, {}, 0};
  else
    std::erase_if(job.frames, [number](const Frame& f) { return f.number == number; });
}

void finish_job(Job& job, NewEvents& events, JobState state, std::optional<Failure> failure,
                std::chrono::seconds retention) {
  job.state = state;
  job.finished = std::chrono::system_clock::now();
  if (retention.count() > 0) job.expires = *job.finished + retention;
  job.eta_s.reset();
  job.error = std::move(failure);
  Json data{{"state", name_of(state)}};
  if (job.error) data["error"] = failure_to_json(*job.error);
  events.append("state", std::move(data));
  events.close();
}

void requeue_job(Job& job, NewEvents& events) {
  job.state = JobState::queued;
  job.eta_s.reset();
  events.append("state", {{"state", name_of(job.state)}});
}

}  // namespace sheaf::server
