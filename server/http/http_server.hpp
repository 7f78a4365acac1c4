// SPDX-License-Identifier: MIT
// Connections to threads. Idle keep-alive connections wait in epoll and cost no thread; a connection takes a thread
// from the pool (worker_pool.hpp) while it sends a request and is sent the reply. A reply that lasts (an event stream)
// takes the connection on to the stream pump. cpp-httplib runs the exchange and writes every other reply.
#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>

#include "http/connection.hpp"
#include "http/message.hpp"
#include "http/stream_pump.hpp"
#include "http/worker_pool.hpp"

namespace sheaf::server {

struct HttpOptions {
  PoolOptions pool;
  std::size_t max_connections = 4000;
  std::uint64_t max_body = std::uint64_t{1} << 30;
  std::chrono::seconds keep_alive{75};  // how long an idle connection may wait for its next request
  std::chrono::seconds drain{3};        // how long replies may continue after stop()
  StreamTimeouts timeouts;
  HeadLimits head;
};

class HttpServer : private httplib::Server {
 public:
  using Handler = std::function<Reply(Request&)>;
  using Observer = std::function<void(const ExchangeRecord&)>;

  /// `handler` may throw Problem, sheaf::Error or anything else: each becomes problem+json.
  HttpServer(HttpOptions options, Handler handler, Observer observer);
  ~HttpServer() override;

  /// Port 0: any free one. Returns "host:port" as bound; throws Error{io}.
  std::string bind(const std::string& host, const std::string& port);

  /// Serves until stop(); then no new connection is accepted, and replies in progress have `drain` to end.
  void run();
  void stop();
  [[nodiscard]] std::size_t connections() const { return open_.load(); }

 private:
  void accept_clients();
  void wake_connection(int fd);
  void close_idle(std::chrono::steady_clock::time_point before);
  void park(ConnectionPtr connection);
  void serve(ConnectionPtr connection);
  void discard(ConnectionPtr connection);
  bool serve_one(ConnectionPtr& connection);
  void hand_over(ConnectionPtr connection, const RequestHead& head, Reply reply, const ExchangeRecord& record,
                 std::chrono::steady_clock::time_point started);
  Reply answer(const RequestHead& head, ClientStream& stream, ExchangeRecord& record);
  bool refuse_head(ClientStream& stream, const class Problem& problem);

  HttpOptions options_;
  Handler handler_;
  Observer observer_;
  Fd listener_, epoll_, wake_;
  std::atomic<bool> stopping_{false};
  std::atomic<std::size_t> open_{0};

  std::mutex mutex_;
  std::map<int, ConnectionPtr> idle_;
  WorkerPool pool_;
  StreamPump pump_;
};

}  // namespace sheaf::server
