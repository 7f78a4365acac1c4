// SPDX-License-Identifier: MIT
#include "routes/contract.hpp"
#include "routes/resources.hpp"
#include "routes/routes.hpp"
#include "settings/setting_json.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::uint64_t max_report = std::uint64_t{64} << 20;

Reply health(RouteContext&, Request&) { return json_reply(200, {{"status", "alive"}, {"version", SHEAF_VERSION}}); }

/// Device, disk and queue, each "ok" or the reason why no job should be sent here.
Reply readiness(RouteContext& context, Request&) {
  const DeviceProbe::Result device = context.device.result();
  const JobService::Readiness jobs = context.service.readiness();
  const nlohmann::ordered_json checks{
      {"device", device.ready ? "ok" : device.reason}, {"disk", jobs.disk}, {"queue", jobs.queue}};
  std::string reasons;
  for (const auto& [name, found] : checks.items())
    if (found != "ok") reasons += (reasons.empty() ? "" : "; ") + name + ": " + found.get<std::string>();
  if (reasons.empty()) return json_reply(200, {{"status", "ready"}, {"checks", checks}});
  throw Problem(ProblemKind::not_ready, reasons).header("Retry-After", "10").member("checks", checks);
}

Reply metrics(RouteContext& context, Request&) {
  return text_reply("text/plain; version=0.0.4; charset=utf-8",
                    context.metrics.text(context.service, {context.streams.used(), context.connections(),
                                                           context.device.result().ready, context.confinement}));
}

Reply report(RouteContext& context, Request&) {
  if (context.report.empty()) throw Problem(ProblemKind::not_produced, "the service was given no report");
  return text_reply("application/json", read_text(context.report, max_report));
}

/// The page with the schema of the settings in it, from which it makes its form.
std::string page_text() {
  std::string text = index_html, schema = settings_schema().dump();
  for (std::size_t at = 0; (at = schema.find("</", at)) != std::string::npos; at += 3) schema.replace(at, 2, "<\\/");
  constexpr std::string_view place = "/* settings */ {}";
  return text.replace(text.find(place), place.size(), schema);
}

Reply page(RouteContext&, Request&) {
  static const std::string text = page_text();
  Reply reply = text_reply("text/html; charset=utf-8", text);
  return reply.header("Content-Security-Policy",
                      "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; "
                      "img-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
}

}  // namespace

void add_service_routes(Router& router, RouteContext& context) {
  const auto get = [&](const std::string& path, Reply (*handler)(RouteContext&, Request&)) {
    router.add("GET", path, [&context, handler](Request& request) {
      request.allow_arguments({});
      return handler(context, request);
    });
  };
  get("/healthz", health);
  get("/readyz", readiness);
  get("/metrics", metrics);
  router.add("GET", "/openapi.json", [text = contract_of(context.service.options()).dump(2)](Request& request) {
    request.allow_arguments({});
    return text_reply("application/json", text);
  });
  get("/v1/report", report);
  get("/", page);
}

}  // namespace sheaf::server
