// SPDX-License-Identifier: MIT
// One request and reply through cpp-httplib, whatever its version: the library calls back once per request, before its
// own routing, and the reply is filled in there.
#pragma once

#include <httplib.h>

#include <functional>
#include <string>

#include "http/message.hpp"
#include "http/problem.hpp"
#include "http/request_head.hpp"

namespace sheaf::server {

/// Names the callback that fills in the reply to the request that this thread is about to run.
class ExchangeScope {
 public:
  using Answer = std::function<void(httplib::Response&)>;
  explicit ExchangeScope(Answer answer);
  ~ExchangeScope();
  ExchangeScope(const ExchangeScope&) = delete;
  ExchangeScope& operator=(const ExchangeScope&) = delete;

 private:
  Answer answer_;
};

/// Makes `server` ask the thread's ExchangeScope for every reply.
void install_exchange(httplib::Server& server);

/// Runs `handler`; what it throws becomes a problem+json reply.
[[nodiscard]] Reply guarded(Request& request, const std::function<Reply(Request&)>& handler);

void fill(httplib::Response& response, Reply reply, const RequestHead& head);

/// Status line and headers of a reply that lasts, written without the library.
[[nodiscard]] std::string lasting_head(const Reply& reply, bool chunked, bool keep);

/// A whole HTTP reply as text, for a head that was refused before it could be routed.
[[nodiscard]] std::string plain_refusal(const Problem& problem);

/// cpp-httplib 0.11 to 0.15 ask the stream for the addresses, later versions take them as arguments; chosen by type.
inline bool run_exchange(httplib::Server& server,
                         bool (httplib::Server::*process)(httplib::Stream&, bool, bool&,
                                                          const std::function<void(httplib::Request&)>&),
                         httplib::Stream& stream) {
  bool closed = false;
  return (server.*process)(stream, false, closed, nullptr);
}
inline bool run_exchange(httplib::Server& server,
                         bool (httplib::Server::*process)(httplib::Stream&, const std::string&, int, const std::string&,
                                                          int, bool, bool&,
                                                          const std::function<void(httplib::Request&)>&),
                         httplib::Stream& stream) {
  bool closed = false;
  return (server.*process)(stream, "", 0, "", 0, false, closed, nullptr);
}

/// An exchange with nobody. cpp-httplib makes its constants at their first use; done before there are threads, even a
/// thread sanitizer that does not see the guards in a library built without it can tell that nobody races for them.
void rehearse(const std::function<bool(httplib::Stream&)>& run);

}  // namespace sheaf::server
