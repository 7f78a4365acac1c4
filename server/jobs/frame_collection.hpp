// SPDX-License-Identifier: MIT
// The frames of a job, found by its files: after a crash of worker, service or machine the files decide.
#pragma once

#include "jobs/job.hpp"
#include "jobs/job_files.hpp"
#include "jobs/job_store.hpp"

namespace sheaf::server {

/// Records frames that are complete on the disk and were not reported (their worker died in between). Returns how many.
std::uint64_t adopt_frames(JobStore& store, const JobFiles& files, const std::string& id);

/// Drops recorded frames whose files have changed, so that they are rendered again; then adopts.
void verify_frames(JobStore& store, const JobFiles& files, const std::string& id);

}  // namespace sheaf::server
