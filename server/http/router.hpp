// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "http/message.hpp"

namespace sheaf::server {

using RouteHandler = std::function<Reply(Request&)>;

/// Patterns are paths whose segments may hold one placeholder with text around it: "/v1/jobs/{id}/frames/{frame}.exr".
/// A GET route also answers HEAD (without the body), and every path answers OPTIONS.
class Router {
 public:
  void add(const std::string& method, const std::string& pattern, RouteHandler handler);

  /// Throws Problem: 501 for an unknown method, 404 for an unknown path, 405 with Allow for a known one.
  Reply dispatch(Request& request) const;

  /// "GET /v1/jobs/{id}", for the contract's test.
  [[nodiscard]] std::vector<std::string> routes() const;

 private:
  struct Segment {
    std::string before, name, after;  // name empty: the segment is `before`
  };
  struct Route {
    std::string method, pattern;
    std::vector<Segment> segments;
    RouteHandler handler;
  };
  static bool matches(const Route& route, const std::vector<std::string>& segments,
                      std::map<std::string, std::string>& parameters);

  std::vector<Route> routes_;
};

}  // namespace sheaf::server
