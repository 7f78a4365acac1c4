// SPDX-License-Identifier: MIT
// The HTTP interface: every route, thin over the job service. Each group stands in its own file.
#pragma once

#include <chrono>
#include <functional>

#include "access/tokens.hpp"
#include "http/router.hpp"
#include "jobs/job_service.hpp"
#include "routes/metrics.hpp"
#include "routes/readiness.hpp"
#include "routes/stream_slots.hpp"

namespace sheaf::server {

struct RouteContext {
  JobService& service;
  StreamSlots& streams;
  Metrics& metrics;
  DeviceProbe& device;
  std::function<std::size_t()> connections;     // open now
  std::vector<std::string> confinement;         // measures that hold for workers
  std::chrono::milliseconds heartbeat{15'000};  // between comments on an idle event stream
  std::string report;                           // a file for the page; empty: none
};

/// `context` outlives the router.
void add_job_routes(Router& router, RouteContext& context);      // submit, list, read, cancel, remove
void add_event_routes(Router& router, RouteContext& context);    // event stream and long poll
void add_result_routes(Router& router, RouteContext& context);   // frames, archive, stats, log
void add_service_routes(Router& router, RouteContext& context);  // health, readiness, metrics, contract, page

/// Handles every request: checks its token, refuses to let another site's page submit, cancel or remove jobs, and calls
/// the route.
[[nodiscard]] Reply handle(const Router& router, const Tokens& tokens, Request& request);

}  // namespace sheaf::server
