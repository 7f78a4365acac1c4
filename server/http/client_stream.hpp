// SPDX-License-Identifier: MIT
// One client's connection. It stands between the socket and cpp-httplib: heads and bodies are read here, under
// deadlines and limits, and the library is shown only a plain request line, so that no byte a stranger sends reaches
// the library's parsers. Replies pass through write().
#pragma once

#include <httplib.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "http/body_reader.hpp"
#include "http/request_head.hpp"
#include "util/fd.hpp"

namespace sheaf::server {

struct StreamTimeouts {
  std::chrono::milliseconds head{10'000};   // for a whole head, from its first byte
  std::chrono::milliseconds read{30'000};   // for the next bytes of a body
  std::chrono::milliseconds write{30'000};  // until the client takes the next bytes of a reply
};

/// Is notified when a client blocks its thread, and when it no longer does.
class StallObserver {
 public:
  virtual ~StallObserver() = default;
  virtual void on_stall(int fd) = 0;
  virtual void on_resume(int fd) = 0;
};

class ClientStream : public httplib::Stream {
 public:
  ClientStream(Fd socket, StreamTimeouts timeouts, HeadLimits limits)
      : socket_(std::move(socket)), timeouts_(timeouts), limits_(limits) {}

  /// `observer` must outlive the stream, or be reset to null.
  void observe_stalls(StallObserver* observer) { observer_ = observer; }

  /// The next request's head; nothing if the client has closed the connection. Throws Problem.
  [[nodiscard]] std::optional<RequestHead> read_head();

  /// Makes read() give the library the request line of `head`, and read_body() its body.
  void begin(const RequestHead& head, std::uint64_t body_limit);
  std::size_t read_body(char* into, std::size_t size);
  [[nodiscard]] bool body_finished() const { return !body_ || body_->finished(); }

  [[nodiscard]] bool has_buffered() const { return !buffer_.empty(); }
  [[nodiscard]] int fd() const { return socket_.get(); }

  /// Ends our side and waits a little for the client's, so that the reply is not lost in a reset when the client is
  /// still sending (RFC 9112, 9.6).
  void close_lingering();

  // What cpp-httplib asks of a stream.
  bool is_readable() const override { return true; }
  bool is_writable() const override;
  ssize_t read(char* into, size_t size) override;
  ssize_t write(const char* bytes, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
  /// Only compared with FD_SETSIZE by the library, which does not use select() on it.
  socket_t socket() const override { return 0; }
  using httplib::Stream::write;

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] bool wait_for(short events, Clock::time_point deadline) const;
  [[nodiscard]] std::size_t receive(char* into, std::size_t size, Clock::time_point deadline);
  [[nodiscard]] std::size_t take(char* into, std::size_t size);

  Fd socket_;
  StallObserver* observer_ = nullptr;
  StreamTimeouts timeouts_;
  HeadLimits limits_;
  std::string buffer_;  // received, not yet used: a pipelined request's bytes stay here
  std::string shown_;   // what the library still has to read
  std::optional<BodyReader> body_;
  bool continue_due_ = false, failed_ = false;
};

}  // namespace sheaf::server
