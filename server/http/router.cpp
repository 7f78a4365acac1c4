// SPDX-License-Identifier: MIT
#include "http/router.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "core/quote.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> segments;
  for (std::size_t at = 1; at <= path.size();) {
    const auto end = std::min(path.find('/', at), path.size());
    segments.push_back(path.substr(at, end - at));
    at = end + 1;
  }
  return segments;
}

std::string allow_list(std::set<std::string> methods) {
  if (methods.contains("GET")) methods.insert("HEAD");
  methods.insert("OPTIONS");
  std::string list;
  for (const std::string& name : methods) list += (list.empty() ? "" : ", ") + name;
  return list;
}

Reply options_reply(const std::set<std::string>& methods) {
  Reply reply;
  reply.status = 204;
  return reply.header("Allow", allow_list(methods));
}

}  // namespace

void Router::add(const std::string& method, const std::string& pattern, RouteHandler handler) {
  Route route{method, pattern, {}, std::move(handler)};
  for (const std::string& text : split_path(pattern)) {
    const auto open = text.find('{');
    const auto close = text.find('}');
    if (open == std::string::npos)
      route.segments.push_back({text, "", ""});
    else
      route.segments.push_back({text.substr(0, open), text.substr(open + 1, close - open - 1), text.substr(close + 1)});
  }
  routes_.push_back(std::move(route));
}

bool Router::matches(const Route& route, const std::vector<std::string>& segments,
                     std::map<std::string, std::string>& parameters) {
  if (route.segments.size() != segments.size()) return false;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& want = route.segments[i];
    const std::string& have = segments[i];
    if (want.name.empty()) {
      if (have != want.before) return false;
      continue;
    }
    if (have.size() <= want.before.size() + want.after.size() || !have.starts_with(want.before) ||
        !have.ends_with(want.after))
      return false;
    parameters[want.name] = have.substr(want.before.size(), have.size() - want.before.size() - want.after.size());
  }
  return true;
}

Reply Router::dispatch(Request& request) const {
  static constexpr std::array known{"GET",     "HEAD",  "POST",  "PUT",     "DELETE",
                                    "OPTIONS", "PATCH", "TRACE", "CONNECT", "QUERY"};
  if (std::ranges::find(known, request.method) == known.end())
    throw Problem(ProblemKind::not_implemented, "method " + quote(request.method) + " is not known");
  std::set<std::string> allowed;
  if (request.path == "*") {  // the whole server: valid for OPTIONS alone
    for (const Route& route : routes_) allowed.insert(route.method);
    return options_reply(allowed);
  }
  const std::vector<std::string> segments = split_path(request.path);
  const std::string method = request.method == "HEAD" ? "GET" : request.method;
  for (const Route& route : routes_) {
    std::map<std::string, std::string> parameters;
    if (!matches(route, segments, parameters)) continue;
    if (route.method == method) {
      request.parameters = std::move(parameters);
      return route.handler(request);
    }
    allowed.insert(route.method);
  }
  if (allowed.empty()) throw Problem(ProblemKind::unknown_route, "there is no route " + quote(request.path));

  if (request.method == "OPTIONS") return options_reply(allowed);
  throw Problem(ProblemKind::method_not_allowed, quote(request.method) + " is not allowed at " + quote(request.path))
      .header("Allow", allow_list(allowed));
}

std::vector<std::string> Router::routes() const {
  std::vector<std::string> names;
  for (const Route& route : routes_) names.push_back(route.method + " " + route.pattern);
  return names;
}

}  // namespace sheaf::server
