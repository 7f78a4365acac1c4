// SPDX-License-Identifier: MIT
#include "http/guarded.hpp"

#include "core/quote.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

Reply failure_reply(const Request& request, const std::string& reason) {
  write_log(LogLevel::error, "request failed", {{"request", request.id}, {"path", request.path}, {"reason", reason}});
  return problem_reply(Problem(ProblemKind::internal, "the reason is in the service's log under request " + request.id),
                       request.path);
}

}  // namespace

Reply problem_reply(const Problem& problem, const std::string& instance) {
  Reply reply;
  reply.status = problem.status();
  reply.refusal = problem.slug();
  reply.content_type = "application/problem+json";
  reply.body =
      problem.body(quote(instance)).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  reply.headers = problem.headers();
  reply.header("Cache-Control", "no-store");
  return reply;
}

Reply guarded(Request& request, const std::function<Reply(Request&)>& handler) {
  try {
    return handler(request);
  } catch (const Problem& problem) {
    return problem_reply(problem, request.path);
  } catch (const Error& error) {
    return problem_reply(problem_of(error), request.path);
  } catch (const std::exception& error) {
    return failure_reply(request, error.what());
  }
}

}  // namespace sheaf::server
