// SPDX-License-Identifier: MIT
// What a job has, told from its files: after a crash of worker, service or machine the files are the truth.
#pragma once

#include "jobs/job.hpp"
#include "jobs/job_files.hpp"
#include "jobs/job_store.hpp"

namespace sheaf::server {

/// Takes in frames that are there whole and were not reported (their worker died between the two). Returns how many.
std::uint64_t adopt_frames(JobStore& store, const JobFiles& files, const std::string& id);

/// Drops recorded frames whose files are not what they were, so that they are rendered again; then adopts.
void verify_frames(JobStore& store, const JobFiles& files, const std::string& id);

}  // namespace sheaf::server
