// SPDX-License-Identifier: MIT
// A job as one JSON text, without what the database keeps in columns and rows of its own (id, sequence, state,
// the scene's name, which may be any bytes, warnings and frames).
#pragma once

#include <string>

#include "jobs/job.hpp"

namespace sheaf::server {

[[nodiscard]] std::string to_record(const Job& job);

/// Throws Error{io} for text that to_record did not write.
void from_record(const std::string& record, Job& job);
void from_record(const std::string& record, JobSummary& job);

[[nodiscard]] std::int64_t to_milliseconds(WallTime time);
[[nodiscard]] WallTime from_milliseconds(std::int64_t milliseconds);

}  // namespace sheaf::server
