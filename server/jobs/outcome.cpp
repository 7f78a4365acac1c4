// SPDX-License-Identifier: MIT
#include "jobs/outcome.hpp"

#include <csignal>

namespace sheaf::server {
namespace {

struct Row {
  const char *code, *title;
};

Row row_of(int exit_code) {
  switch (exit_code) {
    case 2:
      return {"worker-usage", "The worker did not understand its command line"};
    case 3:
      return {"bad-scene", "The scene, camera path or settings are bad"};
    case exit_no_device:
      return {"device", "There is no usable device, or it was lost"};
    case 5:
      return {"limit-exceeded", "A limit was exceeded"};
    case exit_storage:
      return {"storage", "Reading or writing failed"};
    case 128 + SIGINT:
    case 128 + SIGTERM:
      return {"interrupted", "The worker was interrupted"};
    default:
      return {"worker-failed", "The worker failed"};
  }
}

Failure failure(Row row, const std::string& message) { return {row.code, row.title, message, {}, {}}; }

}  // namespace

Outcome outcome_of(const Ending& ending) {
  // The client asked for this end, whatever the worker did after it was told to stop.
  if (ending.cancel_requested) return {JobState::cancelled, std::nullopt};

  if (ending.worker.timed_out)
    return {JobState::failed, failure(row_of(5), "the worker ran longer than --max-wall allows: " +
                                                     std::to_string(ending.wall.count()) + " s")};
  if (ending.worker.signal == SIGXCPU)
    return {JobState::failed, failure(row_of(5), "the worker took more processor time than --max-cpu allows: " +
                                                     std::to_string(ending.cpu_seconds) + " s")};
  if (ending.worker.signal) {
    const int number = *ending.worker.signal;
    Failure reason = failure({"worker-crashed", "The worker crashed"},
                             "worker ended by signal " + std::to_string(number) + " (" + signal_name(number) + ")");
    reason.signal = number;
    return {JobState::failed, reason};
  }
  const int code = ending.worker.exit_code.value_or(-1);
  if (code == 0 && ending.missing == 0) return {JobState::done, std::nullopt};
  if (code == 0) {
    Failure reason = failure({"incomplete", "The worker left frames out"},
                             "the worker succeeded, but " + std::to_string(ending.missing) + " frames are missing");
    reason.exit_code = code;
    return {JobState::failed, reason};
  }
  Failure reason = failure(
      row_of(code), ending.message.empty() ? "worker ended with exit code " + std::to_string(code) : ending.message);
  reason.exit_code = code;
  return {JobState::failed, reason};
}

bool is_transient(const Ending& ending) {
  if (ending.worker.timed_out) return false;
  if (ending.worker.signal) {
    const int number = *ending.worker.signal;
    return number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP;
  }
  const int code = ending.worker.exit_code.value_or(0);
  return code == exit_no_device || code == exit_storage || code == 128 + SIGINT || code == 128 + SIGTERM;
}

Outcome outcome_of_too_many_starts(std::uint64_t starts) {
  return {JobState::failed,
          failure({"interrupted", "The worker was interrupted"}, "the worker was started " + std::to_string(starts) +
                                                                     " times without a new frame, and did not finish")};
}

Outcome outcome_of_lost_files() {
  return {JobState::failed, failure({"storage", "Reading or writing failed"}, "the scene is no longer on the disk")};
}

Outcome outcome_of_no_start(const std::string& reason) {
  return {JobState::failed, failure({"worker-missing", "The worker could not be started"}, reason)};
}

}  // namespace sheaf::server
