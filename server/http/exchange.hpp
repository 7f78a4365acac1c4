// SPDX-License-Identifier: MIT
// The seam to cpp-httplib, all of it. The service accepts connections and reads heads and bodies itself, under
// deadlines and limits that the library does not have (its thread waits for an idle client, so a thousand of them would
// need a thousand threads). The library writes the replies: status line, headers, lengths, chunks, what HEAD leaves
// out.
//
// Its public interface gives that only together with its own accept loop. So HttpServer derives from httplib::Server,
// which offers two protected members to those who bring their own connections:
// - `process_request` runs one exchange over a Stream. Its parameters differ between versions: `run_exchange` has one
//   overload for each, chosen by the member's type.
// - `svr_sock_` says whether the server runs: it ends keep-alive while it is invalid.
// The library calls one handler before its routing, and this handler is told nothing of whose request it is; it runs on
// the thread that asked for the exchange, so a thread_local names the reply (ExchangeScope). The library sees only a
// request line that ClientStream makes up: no byte that a stranger sends reaches its parsers.
#pragma once

#include <httplib.h>

#include <functional>
#include <string>

#include "http/message.hpp"
#include "http/request_head.hpp"
#include "util/problem.hpp"

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
