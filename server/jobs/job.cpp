// SPDX-License-Identifier: MIT
#include "jobs/job.hpp"

#include <algorithm>
#include <array>

#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array states{JobState::queued, JobState::running, JobState::done, JobState::failed, JobState::cancelled};

Json time_or_null(const std::optional<WallTime>& time) { return time ? Json(rfc3339(*time)) : Json(nullptr); }

Json progress_of(const JobSummary& job) {
  const bool counted = job.total && *job.total > 0;
  const double fraction =
      counted ? static_cast<double>(job.frames_done) / static_cast<double>(*job.total) : (job.state == JobState::done);
  return {{"done", job.frames_done},
          {"total", job.total ? Json(*job.total) : Json(nullptr)},
          {"fraction", fraction},
          {"eta_s", job.state == JobState::running && job.eta_s ? Json(*job.eta_s) : Json(nullptr)}};
}

const char* frame_state(const Job& job, const Frame& frame) {
  if (frame.exr) return "done";
  return is_finished(job.state) ? "missing" : "pending";
}

Json frame_to_json(const Job& job, const Frame& frame) {
  Json json{{"frame", frame.number}, {"state", frame_state(job, frame)}};
  if (!frame.exr) return json;
  const std::string base = "/v1/jobs/" + job.id + "/frames/" + std::to_string(frame.number);
  json["wall_ms"] = frame.wall_ms;
  json["name"] = frame.exr->name;
  json["bytes"] = frame.exr->bytes;
  json["sha256"] = frame.exr->sha256;
  json["exr"] = base + ".exr";
  json["png"] = frame.png ? Json(base + ".png") : Json(nullptr);
  json["png_bytes"] = frame.png ? Json(frame.png->bytes) : Json(nullptr);
  json["png_sha256"] = frame.png ? Json(frame.png->sha256) : Json(nullptr);
  return json;
}

Json links_of(const JobSummary& job) {
  const std::string self = "/v1/jobs/" + job.id;
  return {{"self", self},
          {"events", self + "/events"},
          {"frames_zip", self + "/frames.zip"},
          {"stats", self + "/stats.json"},
          {"stats_csv", self + "/stats.csv"},
          {"log", self + "/log"}};
}

}  // namespace

const char* name_of(JobState state) {
  switch (state) {
    case JobState::queued:
      return "queued";
    case JobState::running:
      return "running";
    case JobState::done:
      return "done";
    case JobState::failed:
      return "failed";
    case JobState::cancelled:
      break;
  }
  return "cancelled";
}

std::optional<JobState> job_state_of(const std::string& name) {
  for (const JobState state : states)
    if (name == name_of(state)) return state;
  return std::nullopt;
}

const Frame* find_frame(const std::vector<Frame>& frames, std::int64_t number) {
  const auto found = std::ranges::lower_bound(frames, number, {}, &Frame::number);
  return found != frames.end() && found->number == number ? &*found : nullptr;
}

Frame* find_frame(std::vector<Frame>& frames, std::int64_t number) {
  return const_cast<Frame*>(find_frame(std::as_const(frames), number));
}

Json failure_to_json(const Failure& failure) {
  return {{"type", problem_type(failure.code)},
          {"code", failure.code},
          {"title", failure.title},
          {"message", failure.message},
          {"exit_code", failure.exit_code ? Json(*failure.exit_code) : Json(nullptr)},
          {"signal", failure.signal ? Json(*failure.signal) : Json(nullptr)}};
}

Json summary_to_json(const JobSummary& job) {
  return {{"id", job.id},
          {"state", name_of(job.state)},
          {"cancel_requested", job.cancel_requested},
          {"starts", job.starts},
          {"created", rfc3339(job.created)},
          {"started", time_or_null(job.started)},
          {"finished", time_or_null(job.finished)},
          {"expires", time_or_null(job.expires)},
          {"progress", progress_of(job)},
          {"scene", {{"name", job.scene_file}, {"bytes", job.scene_bytes}, {"camera", job.has_camera}}},
          {"settings", job.settings},
          {"warnings", job.warnings},
          {"error", job.error ? failure_to_json(*job.error) : Json(nullptr)},
          {"links", links_of(job)}};
}

Json job_to_json(const Job& job) {
  Json json = summary_to_json(job);
  Json frames = Json::array();
  for (const Frame& frame : job.frames) frames.push_back(frame_to_json(job, frame));
  json["frames"] = std::move(frames);
  return json;
}

}  // namespace sheaf::server
