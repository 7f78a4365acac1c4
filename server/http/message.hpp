// SPDX-License-Identifier: MIT
// Requests and replies as the routes see them, independent of how they are transferred.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sheaf::server {

using Headers = std::vector<std::pair<std::string, std::string>>;  // in order of arrival; names as received

/// First header of that name, whatever its case.
[[nodiscard]] std::optional<std::string> find_header(const Headers& headers, std::string_view name);
[[nodiscard]] bool equal_ignoring_case(std::string_view a, std::string_view b);
[[nodiscard]] std::string_view trimmed(std::string_view text);

struct Request {
  std::string method, path;  // path: percent-decoded, without the query
  std::vector<std::pair<std::string, std::string>> query;
  Headers headers;
  std::map<std::string, std::string> parameters;  // the route's placeholders
  std::string id;                                 // this request's, for the log
  std::string client;                             // name of its token

  /// Next bytes of the body, at most `size`; 0 at its end. Throws Problem: too slow, cut off, malformed, too large.
  std::function<std::size_t(char* into, std::size_t size)> read_body;

  [[nodiscard]] std::optional<std::string> header(std::string_view name) const { return find_header(headers, name); }
  [[nodiscard]] std::optional<std::string> argument(std::string_view name) const;

  /// Throws Problem (400) for any query key that is not among `names`, or that is given twice.
  void allow_arguments(std::initializer_list<std::string_view> names) const;
};

/// Sends the next bytes of a body; false: the client has gone, stop.
using Writer = std::function<bool(std::string_view bytes)>;

/// A body that is made while it is sent. `produce` returns false to abort the connection, so that the client notices.
struct StreamBody {
  std::optional<std::uint64_t> length;  // chunked without it
  std::function<bool(const Writer& write)> produce;
};

/// A body whose bytes become available over time (event stream, long poll); no thread waits in between.
struct LastingBody {
  /// Appends what is to be sent now; false if the body ends with it.
  std::function<bool(std::string& out)> advance;

  /// When advance() must be called even without a wake.
  std::function<std::chrono::steady_clock::time_point()> due;

  /// Until the result is destroyed, `wake` is called, from any thread, when advance() would append something.
  std::function<std::shared_ptr<void>(std::function<void()> wake)> watch;
};

struct Reply {
  int status = 200;
  Headers headers;
  std::string content_type;
  std::string body;
  std::optional<StreamBody> stream;
  std::optional<LastingBody> lasting;
  std::string refusal;  // a problem's slug

  Reply& header(std::string name, std::string value) {
    headers.emplace_back(std::move(name), std::move(value));
    return *this;
  }
};

[[nodiscard]] Reply json_reply(int status, const nlohmann::ordered_json& body);
[[nodiscard]] Reply text_reply(std::string content_type, std::string body);

}  // namespace sheaf::server
