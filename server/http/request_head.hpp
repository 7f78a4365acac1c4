// SPDX-License-Identifier: MIT
// The start line and headers of a request, read strictly before anything else sees them: CRLF line ends, token names,
// no folded lines, one way to give the body's length. What two parsers could read in two ways is refused, so that a
// proxy in front and this service never disagree on where a request ends.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "http/message.hpp"

namespace sheaf::server {

struct HeadLimits {
  std::size_t bytes = 32 * 1024;  // the head, terminator included
  std::size_t target = 4096;
  std::size_t fields = 100;
};

enum class BodyFraming { none, length, chunked };

struct RequestHead {
  std::string method;
  std::string target;  // path and query; the host of an absolute target is taken off. "*" for OPTIONS alone
  bool http_1_0 = false;
  Headers headers;
  BodyFraming framing = BodyFraming::none;
  std::uint64_t content_length = 0;
  bool keep_alive = true;
  bool expects_continue = false;
};

/// `text` ends with the blank line. Throws Problem: 400, 414, 431.
[[nodiscard]] RequestHead parse_request_head(std::string_view text, const HeadLimits& limits);

/// Target into decoded path and query. Throws Problem 400: bad escapes, control characters, not starting with '/'. "*"
/// is itself.
void split_target(std::string_view target, std::string& path, std::vector<std::pair<std::string, std::string>>& query);

}  // namespace sheaf::server
