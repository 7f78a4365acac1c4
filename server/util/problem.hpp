// SPDX-License-Identifier: MIT
// Every refusal of the service as RFC 9457 problem details. Thrown anywhere below a route, made a reply in guarded.cpp.
#pragma once

#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"

namespace sheaf::server {

/// The kinds of refusal; status, slug and title of each stand in one table (problem.cpp).
enum class ProblemKind {
  malformed_request,
  malformed_multipart,
  malformed_json,
  foreign_origin,
  unauthorized,
  insufficient_scope,
  unknown_route,
  unknown_job,
  unknown_frame,
  not_produced,
  method_not_allowed,
  request_timeout,
  not_rendered,
  not_finished,
  job_removed,
  too_large,
  uri_too_long,
  unsupported_media_type,
  range_not_satisfiable,
  digest_mismatch,
  bad_settings,
  bad_scene,
  idempotency_mismatch,
  limit_exceeded,
  headers_too_large,
  internal,
  not_implemented,
  busy,
  queue_full,
  too_many_streams,
  storage,
  shutting_down,
  not_ready
};

class Problem : public std::exception {
 public:
  Problem(ProblemKind kind, std::string detail);

  Problem& header(std::string name, std::string value) {
    headers_.emplace_back(std::move(name), std::move(value));
    return *this;
  }
  /// A member besides the standard five, such as the limit that was exceeded.
  Problem& member(const std::string& name, nlohmann::json value) {
    members_[name] = std::move(value);
    return *this;
  }

  /// The setting concerned, as a JSON pointer (RFC 6901); left out if the key is too long to repeat.
  Problem& at(std::string_view key);

  /// The limit that was exceeded: its option without the dashes, what it allows, and the actual value (or a lower
  /// bound).
  Problem& exceeded(const char* name, std::uint64_t limit, std::uint64_t value) {
    return member("limit_name", name).member("limit", limit).member("value", value);
  }

  [[nodiscard]] int status() const;
  [[nodiscard]] const char* slug() const;
  [[nodiscard]] ProblemKind kind() const { return kind_; }
  [[nodiscard]] const std::string& detail() const { return detail_; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& headers() const { return headers_; }
  [[nodiscard]] const char* what() const noexcept override { return detail_.c_str(); }
  [[nodiscard]] nlohmann::ordered_json body(const std::string& instance) const;

 private:
  ProblemKind kind_;
  std::string detail_;
  std::vector<std::pair<std::string, std::string>> headers_;
  nlohmann::json members_ = nlohmann::json::object();
};

/// The engine's errors as refusals of a request.
[[nodiscard]] Problem problem_of(const Error& error);

/// "urn:sheaf:problem:SLUG", what `type` holds.
[[nodiscard]] std::string problem_type(const std::string& slug);

}  // namespace sheaf::server
