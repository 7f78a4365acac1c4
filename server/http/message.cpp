// SPDX-License-Identifier: MIT
#include "http/message.hpp"

#include <algorithm>
#include <set>

#include "core/quote.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

}  // namespace

bool equal_ignoring_case(std::string_view a, std::string_view b) { return std::ranges::equal(a, b, {}, lower, lower); }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<std::string> find_header(const Headers& headers, std::string_view name) {
  for (const auto& [key, value] : headers)
    if (equal_ignoring_case(key, name)) return value;
  return std::nullopt;
}

std::optional<std::string> Request::argument(std::string_view name) const {
  for (const auto& [key, value] : query)
    if (key == name) return value;
  return std::nullopt;
}

void Request::allow_arguments(std::initializer_list<std::string_view> names) const {
  std::set<std::string_view> seen;
  for (const auto& [key, value] : query) {
    if (std::ranges::find(names, key) == names.end())
      throw Problem(ProblemKind::malformed_request, "query: unknown argument '" + quote(key) + "'");
    if (!seen.insert(key).second)
      throw Problem(ProblemKind::malformed_request, "query: argument '" + quote(key) + "' is given twice");
  }
}

Reply json_reply(int status, const nlohmann::ordered_json& body) {
  Reply reply;
  reply.status = status;
  reply.content_type = "application/json";
  reply.body = body.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  return reply;
}

Reply text_reply(std::string content_type, std::string body) {
  Reply reply;
  reply.content_type = std::move(content_type);
  reply.body = std::move(body);
  return reply;
}

}  // namespace sheaf::server
