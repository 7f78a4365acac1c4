// SPDX-License-Identifier: MIT
// One client's connection: reads requests' heads and bodies and writes replies, under deadlines and limits.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "http/body_reader.hpp"
#include "http/request_head.hpp"
#include "util/fd.hpp"

namespace sheaf::server {

struct StreamTimeouts {
  std::chrono::milliseconds head{10'000};   // for a whole head, from its first byte
  std::chrono::milliseconds read{30'000};   // for the next bytes of a body
  std::chrono::milliseconds write{30'000};  // until the client takes the next bytes of a reply
};

/// Is told when a client keeps its thread waiting, and when no more.
class StallObserver {
 public:
  virtual ~StallObserver() = default;
  virtual void stalls(int fd) = 0;
  virtual void goes_on(int fd) = 0;
};

class ClientStream {
 public:
  ClientStream(Fd socket, StreamTimeouts timeouts, HeadLimits limits)
      : socket_(std::move(socket)), timeouts_(timeouts), limits_(limits) {}

  /// `observer` outlives the stream, or is taken away again.
  void tell_stalls(StallObserver* observer) { observer_ = observer; }

  /// Next request's head; nothing if the client has closed. Throws Problem.
  [[nodiscard]] std::optional<RequestHead> read_head();

  /// From now on read_body() gives the body of this request.
  void begin(const RequestHead& head, std::uint64_t body_limit);
  std::size_t read_body(char* into, std::size_t size);
  [[nodiscard]] bool body_finished() const { return !body_ || body_->finished(); }

  [[nodiscard]] bool has_buffered() const { return !buffer_.empty(); }
  [[nodiscard]] int fd() const { return socket_.get(); }

  /// Writes all of it. False, from then on, if the client has gone or takes nothing for too long.
  bool write(std::string_view bytes);

  /// Ends our side and waits a little for the client's, so that the reply is not lost in a reset when the client is
  /// still sending (RFC 9112, 9.6).
  void close_gently();

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
  std::optional<BodyReader> body_;
  bool continue_due_ = false, failed_ = false;
};

}  // namespace sheaf::server
