// SPDX-License-Identifier: MIT
// Jobs, frames and events as rows of the database. Nothing here locks: a connection is one thread's at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "jobs/event_log.hpp"
#include "jobs/job.hpp"
#include "jobs/job_store.hpp"
#include "store/database.hpp"

namespace sheaf::server {

/// Makes the tables where they are missing. Throws Error{io} for a database of a newer version.
void prepare_tables(Database& database);

/// A new job's row and first events; sets its sequence.
void insert_job(Database& database, Job& job, const Idempotency& idempotency, const std::vector<Event>& events);

/// What changed between `old` and `job`, and `events`, all of which are new.
void update_job(Database& database, const Job& old, const Job& job, const std::vector<Event>& events);

/// Takes everything of a job out and remembers its id with the reason; false if it is not there.
bool remove_job(Database& database, const std::string& id, const std::string& reason);

[[nodiscard]] std::optional<Job> load_job(Database& database, const std::string& id);
[[nodiscard]] std::vector<Event> load_events(Database& database, const std::string& id);

/// Ids in order of submission.
[[nodiscard]] std::vector<std::string> unfinished_jobs(Database& database);

/// Newest first, without frames.
[[nodiscard]] JobPage load_page(Database& database, const JobQuery& query);

}  // namespace sheaf::server
