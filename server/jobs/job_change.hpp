// SPDX-License-Identifier: MIT
// The changes of a job's state, each with its events.
#pragma once

#include <chrono>
#include <optional>

#include "jobs/event_log.hpp"
#include "jobs/job.hpp"

namespace sheaf::server {

/// Records a rendered frame and adds its event. False if it was recorded before (then it is replaced).
bool put_frame(Job& job, const Frame& frame, NewEvents& events);

/// A recorded frame is lost.
void drop_frame(Job& job, std::int64_t number);

/// Sets final state, times and expiry, adds the event, closes the event log. `retention` 0: kept for ever.
void finish_job(Job& job, NewEvents& events, JobState state, std::optional<Failure> failure,
                std::chrono::seconds retention);

/// Puts the job back into the queue: its worker or the service ended, the job did not.
void requeue_job(Job& job, NewEvents& events);

}  // namespace sheaf::server
