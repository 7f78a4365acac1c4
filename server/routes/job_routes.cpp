// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <charconv>

#include "core/quote.hpp"
#include "routes/routes.hpp"
#include "upload/submission.hpp"
#include "util/ids.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

constexpr std::uint64_t max_page = 200, default_page = 50;

std::string idempotency_key(const Request& request) {
  const std::optional<std::string> key = request.header("Idempotency-Key");
  if (!key) return {};
  if (key->empty() || key->size() > 255 || !std::ranges::all_of(*key, [](char c) { return c > 32 && c < 127; }))
    throw Problem(ProblemKind::malformed_request, "Idempotency-Key: must be 1 to 255 visible ASCII characters");
  return *key;
}

Reply submit(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const std::string key = idempotency_key(request);
  context.service.check_capacity();
  Submission submission =
      receive_submission(random_id(), request, context.service.files(), context.service.options().limits);
  const JobService::AdmissionTicket ticket = context.service.admit(submission.job);
  context.service.inspect(submission.job);
  const Submitted submitted =
      context.service.submit(std::move(submission.job), {key, submission.fingerprint}, request.id);
  if (submitted.kind == Submitted::Kind::conflict)
    throw Problem(ProblemKind::idempotency_mismatch, "Idempotency-Key '" + quote(key) + "' belongs to job " +
                                                         submitted.id + ", which was submitted with another body");
  Reply reply = json_reply(202, job_to_json(context.service.get(submitted.id)));
  if (submitted.kind == Submitted::Kind::repeated) reply.header("Idempotent-Replayed", "true");
  return reply.header("Location", "/v1/jobs/" + submitted.id);
}

std::uint64_t number(const Request& request, const char* name, std::uint64_t fallback, std::uint64_t least,
                     std::uint64_t most) {
  const std::optional<std::string> text = request.argument(name);
  if (!text) return fallback;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size() || value < least || value > most)
    throw Problem(ProblemKind::malformed_request, "query: " + std::string(name) + " must be a whole number from " +
                                                      std::to_string(least) + " to " + std::to_string(most));
  return value;
}

Reply list(RouteContext& context, Request& request) {
  request.allow_arguments({"cursor", "limit", "state"});
  JobQuery query;
  query.limit = static_cast<std::size_t>(number(request, "limit", default_page, 1, max_page));
  if (request.argument("cursor")) query.before = number(request, "cursor", 0, 1, UINT64_MAX);
  if (const auto state = request.argument("state")) {
    query.state = job_state_of(*state);
    if (!query.state)
      throw Problem(ProblemKind::malformed_request,
                    "query: state must be one of queued, running, done, failed, cancelled");
  }
  const JobPage page = context.service.store().list(query);
  nlohmann::ordered_json jobs = nlohmann::ordered_json::array();
  for (const JobSummary& job : page.jobs) jobs.push_back(summary_to_json(job));
  const nlohmann::ordered_json next = page.next ? nlohmann::ordered_json(std::to_string(*page.next)) : nullptr;
  return json_reply(200, {{"jobs", std::move(jobs)}, {"next", next}});
}

Reply get_job(RouteContext& context, Request& request) {
  request.allow_arguments({});
  return json_reply(200, job_to_json(context.service.get(request.parameters["id"])));
}

/// Never removes a job, whatever happens at the same time: 202 while it stops, 200 once it has ended.
Reply cancel(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const Job job = context.service.cancel(request.parameters["id"]);
  return json_reply(is_finished(job.state) ? 200 : 202, job_to_json(job));
}

Reply cancel_or_remove(RouteContext& context, Request& request) {
  request.allow_arguments({});
  const std::optional<Job> job = context.service.cancel_or_remove(request.parameters["id"]);
  if (job) return json_reply(202, job_to_json(*job));
  Reply reply;
  reply.status = 204;
  return reply;
}

}  // namespace

void add_job_routes(Router& router, RouteContext& context) {
  router.add("POST", "/v1/jobs", [&context](Request& request) { return submit(context, request); });
  router.add("GET", "/v1/jobs", [&context](Request& request) { return list(context, request); });
  router.add("GET", "/v1/jobs/{id}", [&context](Request& request) { return get_job(context, request); });
  router.add("DELETE", "/v1/jobs/{id}", [&context](Request& request) { return cancel_or_remove(context, request); });
  router.add("POST", "/v1/jobs/{id}/cancel", [&context](Request& request) { return cancel(context, request); });
}

Reply handle(const Router& router, const Tokens& tokens, Request& request) {
  // Probes have no tokens; the contract and the page contain nobody's data; OPTIONS repeats the contract.
  static constexpr std::array open{"/healthz", "/readyz", "/openapi.json", "/"};
  const bool reads = request.method == "GET" || request.method == "HEAD";
  const bool free = (reads && std::ranges::find(open, request.path) != open.end()) || request.method == "OPTIONS";
  if (!free) request.client = tokens.authorize(request, reads ? Scope::read : Scope::submit);
  const bool changes = request.method == "POST" || request.method == "DELETE";
  // Browsers say from which kind of site a request comes; a page of another site must not use a service on this
  // machine.
  if (changes && request.header("Sec-Fetch-Site").value_or("same-origin") == "cross-site")
    throw Problem(ProblemKind::foreign_origin, "the request comes from a page of another site");
  Reply reply = router.dispatch(request);
  if (!find_header(reply.headers, "Cache-Control")) reply.header("Cache-Control", "no-store");
  return reply;
}

}  // namespace sheaf::server
