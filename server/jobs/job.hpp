// SPDX-License-Identifier: MIT
// A job as the service knows it: plain data. Everything a client is shown is made from it in job.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "util/clock.hpp"

namespace sheaf::server {

enum class JobState { queued, running, done, failed, cancelled };

[[nodiscard]] const char* name_of(JobState state);
[[nodiscard]] std::optional<JobState> job_state_of(const std::string& name);
[[nodiscard]] inline bool is_finished(JobState state) {
  return state != JobState::queued && state != JobState::running;
}

/// A whole file beside the job, as it was when the worker reported it.
struct StoredFile {
  std::string name;  // within the job's frames folder
  std::uint64_t bytes = 0;
  std::uint32_t crc32 = 0;
  std::string sha256;
};

using StoredFilePtr = std::shared_ptr<const StoredFile>;  // jobs are copied often, their files' names seldom change

struct Frame {
  std::int64_t number = 0;
  StoredFilePtr exr, png;  // exr is there once the frame is rendered
  double wall_ms = 0;
};

/// Why a job failed, in words and in numbers a program can act on.
struct Failure {
  std::string code, title, message;  // code: the problem's slug
  std::optional<int> exit_code, signal;
};

/// What a list of jobs shows of one.
struct JobSummary {
  std::string id;
  std::uint64_t sequence = 0;  // order of submission
  JobState state = JobState::queued;
  bool cancel_requested = false;
  WallTime created{};
  std::optional<WallTime> started, finished, expires;
  std::uint64_t starts = 0;            // of its worker
  std::uint64_t fruitless_starts = 0;  // of them, since the last new frame

  std::string scene_file;  // within the job's scene folder
  std::uint64_t scene_bytes = 0;
  bool has_camera = false;
  nlohmann::ordered_json settings;

  std::optional<std::uint64_t> total;  // frames, as told by the client or the worker
  std::uint64_t frames_done = 0;
  std::optional<double> eta_s;  // the worker's own estimate at its last frame
  std::vector<std::string> warnings;
  std::optional<Failure> error;
};

struct Job : JobSummary {
  std::vector<std::string> arguments;  // the worker's, from the settings
  std::vector<Frame> frames;           // by number; all of them where frames_known
  bool frames_known = false;           // the client named them; else they are added as they come
};

/// The frame, or null. `frames` is sorted by number.
[[nodiscard]] Frame* find_frame(std::vector<Frame>& frames, std::int64_t number);
[[nodiscard]] const Frame* find_frame(const std::vector<Frame>& frames, std::int64_t number);

[[nodiscard]] nlohmann::ordered_json job_to_json(const Job& job);
[[nodiscard]] nlohmann::ordered_json summary_to_json(const JobSummary& job);
[[nodiscard]] nlohmann::ordered_json failure_to_json(const Failure& failure);

}  // namespace sheaf::server
