// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "jobs/job_service.hpp"

namespace sheaf::server {

/// What this service allows, as /openapi.json tells it: for each limit its value, unit, and how passing it is answered.
[[nodiscard]] nlohmann::ordered_json limit_table(const ServiceOptions& options);

}  // namespace sheaf::server
