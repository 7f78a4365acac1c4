// SPDX-License-Identifier: MIT
#include "util/problem.hpp"

#include "core/quote.hpp"

namespace sheaf::server {
namespace {

struct Row {
  int status;
  const char *slug, *title;
};

Row row_of(ProblemKind kind) {
  switch (kind) {
    case ProblemKind::malformed_request:
      return {400, "malformed-request", "The request is malformed"};
    case ProblemKind::malformed_multipart:
      return {400, "malformed-multipart", "The multipart body is malformed"};
    case ProblemKind::malformed_json:
      return {400, "malformed-json", "A JSON part is not JSON"};
    case ProblemKind::foreign_origin:
      return {403, "foreign-origin", "Requests from pages of other sites are refused"};
    case ProblemKind::unauthorized:
      return {401, "unauthorized", "A token is needed"};
    case ProblemKind::insufficient_scope:
      return {403, "insufficient-scope", "The token does not allow this"};
    case ProblemKind::unknown_route:
      return {404, "unknown-route", "There is no such route"};
    case ProblemKind::unknown_job:
      return {404, "unknown-job", "There is no such job"};
    case ProblemKind::unknown_frame:
      return {404, "unknown-frame", "The job has no such frame"};
    case ProblemKind::not_produced:
      return {404, "not-produced", "The job did not produce this"};
    case ProblemKind::method_not_allowed:
      return {405, "method-not-allowed", "The method is not allowed here"};
    case ProblemKind::request_timeout:
      return {408, "request-timeout", "The request took too long to arrive"};
    case ProblemKind::not_rendered:
      return {409, "not-rendered", "The frame is not rendered yet"};
    case ProblemKind::not_finished:
      return {409, "not-finished", "The job is not finished yet"};
    case ProblemKind::job_removed:
      return {410, "job-removed", "The job was removed"};
    case ProblemKind::too_large:
      return {413, "too-large", "The upload is too large"};
    case ProblemKind::uri_too_long:
      return {414, "uri-too-long", "The request target is too long"};
    case ProblemKind::unsupported_media_type:
      return {415, "unsupported-media-type", "The media type is not supported"};
    case ProblemKind::range_not_satisfiable:
      return {416, "range-not-satisfiable", "The range starts beyond the end"};
    case ProblemKind::digest_mismatch:
      return {422, "digest-mismatch", "The upload does not match its digest"};
    case ProblemKind::bad_settings:
      return {422, "bad-settings", "The settings are not valid"};
    case ProblemKind::bad_scene:
      return {422, "bad-scene", "The scene upload is not valid"};
    case ProblemKind::idempotency_mismatch:
      return {422, "idempotency-mismatch", "The Idempotency-Key was used for another request"};
    case ProblemKind::limit_exceeded:
      return {422, "limit-exceeded", "A limit is exceeded"};
    case ProblemKind::headers_too_large:
      return {431, "headers-too-large", "The request's headers are too large"};
    case ProblemKind::internal:
      return {500, "internal", "The service failed"};
    case ProblemKind::not_implemented:
      return {501, "not-implemented", "The method is not known"};
    case ProblemKind::busy:
      return {503, "busy", "The service is busy"};
    case ProblemKind::queue_full:
      return {503, "queue-full", "The queue is full"};
    case ProblemKind::too_many_streams:
      return {503, "too-many-streams", "Too many clients are watching"};
    case ProblemKind::storage:
      return {503, "storage", "The service cannot store files now"};
    case ProblemKind::shutting_down:
      return {503, "shutting-down", "The service is stopping"};
    case ProblemKind::not_ready:
      return {503, "not-ready", "The service is not ready for work"};
  }
  return {500, "internal", "The service failed"};
}

}  // namespace

Problem::Problem(ProblemKind kind, std::string detail) : kind_(kind), detail_(std::move(detail)) {}

Problem& Problem::at(std::string_view key) {
  if (quote(key) != key) return *this;
  std::string pointer = "/";
  for (const char c : key) pointer += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return member("pointer", std::move(pointer));
}

int Problem::status() const { return row_of(kind_).status; }

const char* Problem::slug() const { return row_of(kind_).slug; }

nlohmann::ordered_json Problem::body(const std::string& instance) const {
  const Row row = row_of(kind_);
  nlohmann::ordered_json body{{"type", problem_type(row.slug)},
                              {"title", row.title},
                              {"status", row.status},
                              {"detail", detail_},
                              {"instance", instance}};
  for (const auto& [name, value] : members_.items()) body[name] = value;
  return body;
}

Problem problem_of(const Error& error) {
  switch (error.kind()) {
    case ErrorKind::usage:
      return {ProblemKind::bad_settings, error.what()};
    case ErrorKind::input:
      return {ProblemKind::bad_scene, error.what()};
    case ErrorKind::limit:
      return {ProblemKind::limit_exceeded, error.what()};
    case ErrorKind::io:
      return Problem(ProblemKind::storage, error.what()).header("Retry-After", "30");
    case ErrorKind::device:
      return Problem(ProblemKind::not_ready, error.what()).header("Retry-After", "30");
    case ErrorKind::interrupted:
      break;
  }
  return {ProblemKind::internal, error.what()};
}

std::string problem_type(const std::string& slug) { return "urn:sheaf:problem:" + slug; }

}  // namespace sheaf::server
