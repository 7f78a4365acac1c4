// SPDX-License-Identifier: MIT
#include "http/request_head.hpp"

#include <algorithm>
#include <charconv>

#include "core/quote.hpp"
#include "util/problem.hpp"

namespace sheaf::server {
namespace {

[[noreturn]] void malformed(const std::string& why) { throw Problem(ProblemKind::malformed_request, why); }

bool is_token_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool is_token(std::string_view text) { return !text.empty() && std::ranges::all_of(text, is_token_character); }

bool is_field_text(std::string_view text) {
  return std::ranges::all_of(text,
                             [](char c) { return c == '\t' || (static_cast<unsigned char>(c) >= 32 && c != 127); });
}

std::string_view take_line(std::string_view& text) {
  const auto end = text.find('\n');
  if (end == std::string_view::npos || end == 0 || text[end - 1] != '\r')
    malformed("a header line does not end in CRLF");
  const std::string_view line = text.substr(0, end - 1);
  text.remove_prefix(end + 1);
  return line;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_host_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) ||
         std::string_view("-._~%!$&'()*+,;=").find(c) != std::string_view::npos;
}

/// HOST or HOST:PORT (RFC 3986, 3.2.2 and 3.2.3), without user information.
bool is_host_and_port(std::string_view text) {
  std::string_view host = text.substr(0, text.rfind(':'));
  if (text.starts_with('[')) {
    const auto close = text.find(']');
    if (close == std::string_view::npos || close < 2) return false;
    host = text.substr(0, close + 1);
    if (!std::ranges::all_of(host.substr(1, close - 1), [](char c) { return c == ':' || is_host_character(c); }))
      return false;
  } else if (!std::ranges::all_of(host, is_host_character)) {
    return false;
  }
  const std::string_view port = text.substr(host.size());
  return !host.empty() && (port.empty() || (port.front() == ':' && std::ranges::all_of(port.substr(1), is_digit)));
}

/// The path and query of a target in absolute form, which a server must accept (RFC 9112, 3.2.2). A path that is not
/// there is "/", for OPTIONS "*" (3.2.4). Behind a proxy that ends TLS the scheme may be https.
std::string origin_form(std::string_view target, std::string_view method) {
  const auto colon = target.find("://");
  if (colon == std::string_view::npos) malformed("the request target is not a path");
  const std::string_view scheme = target.substr(0, colon);
  if (!equal_ignoring_case(scheme, "http") && !equal_ignoring_case(scheme, "https"))
    malformed("the request target's scheme is neither http nor https");
  const std::string_view rest = target.substr(colon + 3);
  const auto end = std::min(rest.find_first_of("/?"), rest.size());
  if (!is_host_and_port(rest.substr(0, end))) malformed("the request target's host is not HOST or HOST:PORT");
  const std::string_view path = rest.substr(end);
  if (path.empty() && method == "OPTIONS") return "*";
  return (path.starts_with('/') ? "" : "/") + std::string(path);
}

void parse_start_line(std::string_view line, const HeadLimits& limits, RequestHead& head) {
  const auto first = line.find(' ');
  const auto last = line.rfind(' ');
  if (first == std::string_view::npos || last == first) malformed("the request line is not METHOD TARGET VERSION");
  head.method = line.substr(0, first);
  head.target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (!is_token(head.method)) malformed("the method is not a token");
  if (version != "HTTP/1.1" && version != "HTTP/1.0") malformed("the version is neither HTTP/1.1 nor HTTP/1.0");
  head.http_1_0 = version == "HTTP/1.0";
  if (head.target.size() > limits.target)
    throw Problem(ProblemKind::uri_too_long, "the request target has " + std::to_string(head.target.size()) +
                                                 " bytes, the limit is " + std::to_string(limits.target));
  if (std::ranges::any_of(head.target, [](char c) { return static_cast<unsigned char>(c) <= 32 || c == 127; }))
    malformed("the request target holds a space or control character");
  const bool whole_server = head.target == "*" && head.method == "OPTIONS";
  if (!head.target.starts_with('/') && !whole_server) head.target = origin_form(head.target, head.method);
}

std::uint64_t parse_length(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty())
    malformed("Content-Length is not a number");
  return value;
}

void find_framing(RequestHead& head) {
  std::optional<std::string_view> length;
  std::size_t transfer_encodings = 0, hosts = 0;
  for (const auto& [name, value] : head.headers) {
    if (equal_ignoring_case(name, "Content-Length")) {
      if (length && *length != value) malformed("two Content-Length headers disagree");
      length = value;
    } else if (equal_ignoring_case(name, "Transfer-Encoding")) {
      ++transfer_encodings;
      if (!equal_ignoring_case(value, "chunked")) malformed("Transfer-Encoding other than chunked is not supported");
    } else if (equal_ignoring_case(name, "Host")) {
      ++hosts;
      if (!value.empty() && !is_host_and_port(value)) malformed("Host is not HOST or HOST:PORT");
    } else if (equal_ignoring_case(name, "Connection")) {
      if (equal_ignoring_case(value, "close")) head.keep_alive = false;
    } else if (equal_ignoring_case(name, "Expect")) {
      head.expects_continue = equal_ignoring_case(value, "100-continue");
    }
  }
  if (hosts > 1 || (hosts == 0 && !head.http_1_0)) malformed("a request needs one Host header");
  if (transfer_encodings > 1 || (transfer_encodings == 1 && (length || head.http_1_0)))
    malformed("Transfer-Encoding is given twice, with a Content-Length or in HTTP/1.0");
  if (transfer_encodings == 1) head.framing = BodyFraming::chunked;
  if (length) {
    head.content_length = parse_length(*length);
    head.framing = head.content_length > 0 ? BodyFraming::length : BodyFraming::none;
  }
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view text, bool plus_is_space) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0) malformed("the request target holds a '%' without two hexadecimal digits");
      c = static_cast<char>(high * 16 + low);
      i += 2;
    } else if (c == '+' && plus_is_space) {
      c = ' ';
    }
    if (static_cast<unsigned char>(c) < 32 || c == 127) malformed("the request target holds a control character");
    out += c;
  }
  return out;
}

}  // namespace

RequestHead parse_request_head(std::string_view text, const HeadLimits& limits) {
  RequestHead head;
  parse_start_line(take_line(text), limits, head);
  for (std::string_view line = take_line(text); !line.empty(); line = take_line(text)) {
    if (head.headers.size() == limits.fields)
      throw Problem(ProblemKind::headers_too_large, "more than " + std::to_string(limits.fields) + " header fields");
    const auto colon = line.find(':');
    if (colon == std::string_view::npos || !is_token(line.substr(0, colon)))
      malformed("a header line is not NAME: VALUE");
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!is_field_text(value)) malformed("header " + quote(line.substr(0, colon)) + " holds a control character");
    head.headers.emplace_back(line.substr(0, colon), value);
  }
  if (head.http_1_0) head.keep_alive = false;
  find_framing(head);
  return head;
}

void split_target(std::string_view target, std::string& path, std::vector<std::pair<std::string, std::string>>& query) {
  path = target;
  if (target == "*") return;
  if (!target.starts_with('/')) malformed("the request target is not a path");
  const auto mark = target.find('?');
  path = percent_decoded(target.substr(0, mark), false);
  if (mark == std::string_view::npos) return;
  std::string_view rest = target.substr(mark + 1);
  while (!rest.empty()) {
    const auto end = rest.find('&');
    const std::string_view pair = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
    if (pair.empty()) continue;
    const auto equals = pair.find('=');
    query.emplace_back(percent_decoded(pair.substr(0, equals), true),
                       equals == std::string_view::npos ? "" : percent_decoded(pair.substr(equals + 1), true));
  }
}

}  // namespace sheaf::server
