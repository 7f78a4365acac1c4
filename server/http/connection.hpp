// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <memory>

#include "http/client_stream.hpp"

namespace sheaf::server {

struct Connection {
  Connection(Fd socket, const StreamTimeouts& timeouts, const HeadLimits& limits)
      : stream(std::move(socket), timeouts, limits) {}
  ClientStream stream;
  std::chrono::steady_clock::time_point idle_since = std::chrono::steady_clock::now();
};
using ConnectionPtr = std::unique_ptr<Connection>;

/// What the log and the metrics get of each finished exchange.
struct ExchangeRecord {
  std::string id, method, path;
  std::string job;      // the route's, if it names one
  std::string client;   // name of its token
  std::string refusal;  // the problem's slug; empty for an answer that is none
  int status = 0;
  std::chrono::duration<double> seconds{0};
};

}  // namespace sheaf::server
