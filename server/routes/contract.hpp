// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "jobs/job_service.hpp"

namespace sheaf::server {

/// What /openapi.json answers: the routes of resources/openapi.json, the engine's settings, and the limits of this very
/// service.
[[nodiscard]] nlohmann::ordered_json contract_of(const ServiceOptions& options);

}  // namespace sheaf::server
