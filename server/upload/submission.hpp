// SPDX-License-Identifier: MIT
// Receives the body of POST /v1/jobs: writes its parts to files in the job's folder and checks them.
#pragma once

#include <string>

#include "http/message.hpp"
#include "jobs/job.hpp"
#include "jobs/job_files.hpp"
#include "jobs/limits.hpp"

namespace sheaf::server {

struct Submission {
  Job job;
  std::string fingerprint;  // equal for equal parts in equal order, whatever the boundary
};

/// Receives into files.receive(id). Throws Problem, Error; then nothing is left behind.
[[nodiscard]] Submission receive_submission(const std::string& id, Request& request, const JobFiles& files,
                                            const Limits& limits);

}  // namespace sheaf::server
