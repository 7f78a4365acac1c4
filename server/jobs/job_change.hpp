// SPDX-License-Identifier: MIT
// The changes a job goes through, each with the events that tell of it.
#pragma once

#include <chrono>
#include <optional>

#include "jobs/event_log.hpp"
#include "jobs/job.hpp"

namespace sheaf::server {

/// A frame's files are there: records it and says so. False if it was recorded before (then it is replaced).
bool put_frame(Job& job, const Frame& frame, NewEvents& events);

/// A recorded frame is lost.
void drop_frame(Job& job, std::int64_t number);

/// Sets the end's state, times and expiry, tells the watchers, closes the event log. `retention` 0: kept for ever.
void finish_job(Job& job, NewEvents& events, JobState state, std::optional<Failure> failure,
                std::chrono::seconds retention);

/// Back into the queue: its worker or the service went away, not the job.
void requeue_job(Job& job, NewEvents& events);

}  // namespace sheaf::server
