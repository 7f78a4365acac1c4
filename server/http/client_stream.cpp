// SPDX-License-Identifier: MIT
#include "http/client_stream.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "util/problem.hpp"

namespace sheaf::server {
namespace {

using Clock = std::chrono::steady_clock;

/// False at the deadline.
bool wait_until_ready(int fd, short events, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd entry{fd, events, 0};
    const int n = ::poll(&entry, 1, static_cast<int>(std::min<long long>(left, 60'000)));
    if (n > 0) return true;
    if (n < 0 && errno != EINTR) return false;
  }
}

}  // namespace

bool ClientStream::wait_for(short events, Clock::time_point deadline) const {
  pollfd entry{socket_.get(), events, 0};
  if (!observer_ || ::poll(&entry, 1, 0) != 0) return wait_until_ready(socket_.get(), events, deadline);
  observer_->on_stall(socket_.get());
  const bool ready = wait_until_ready(socket_.get(), events, deadline);
  observer_->on_resume(socket_.get());
  return ready;
}

std::size_t ClientStream::receive(char* into, std::size_t size, Clock::time_point deadline) {
  while (true) {
    const ssize_t n = ::recv(socket_.get(), into, size, MSG_DONTWAIT);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return 0;  // a reset ends the connection
    if (!wait_for(POLLIN, deadline))
      throw Problem(ProblemKind::request_timeout, "no further bytes of the request came in time");
  }
}

std::optional<RequestHead> ClientStream::read_head() {
  const auto deadline = Clock::now() + timeouts_.head;
  std::size_t searched = 0;
  while (true) {
    while (buffer_.starts_with("\r\n")) buffer_.erase(0, 2);  // RFC 9112, 2.2: stray line ends before a request
    const auto end = buffer_.find("\r\n\r\n", searched);
    if (end != std::string::npos && end + 4 <= limits_.bytes) {
      const std::string text = buffer_.substr(0, end + 4);
      buffer_.erase(0, end + 4);
      return parse_request_head(text, limits_);
    }
    if (buffer_.size() >= limits_.bytes)
      throw Problem(ProblemKind::headers_too_large,
                    "the request head has more than " + std::to_string(limits_.bytes) + " bytes");
    searched = buffer_.size() < 3 ? 0 : buffer_.size() - 3;
    char block[4096];
    const std::size_t n = receive(block, sizeof block, deadline);
    if (n == 0) return std::nullopt;
    buffer_.append(block, n);
  }
}

void ClientStream::begin(const RequestHead& head, std::uint64_t body_limit) {
  // The library knows few methods and only needs to know whether a body is to be sent.
  shown_ = std::string(head.method == "HEAD" ? "HEAD" : "GET") + " / HTTP/1." + (head.http_1_0 ? "0" : "1") + "\r\n";
  if (!head.keep_alive) shown_ += "Connection: close\r\n";
  shown_ += "\r\n";
  continue_due_ = head.expects_continue;
  body_.emplace(head, body_limit, [this](char* into, std::size_t size) { return take(into, size); });
}

std::size_t ClientStream::take(char* into, std::size_t size) {
  if (continue_due_) {
    continue_due_ = false;
    write("HTTP/1.1 100 Continue\r\n\r\n");
  }
  if (buffer_.empty()) {
    if (size >= 4096) return receive(into, size, Clock::now() + timeouts_.read);
    buffer_.resize(4096);
    std::size_t n = 0;
    try {
      n = receive(buffer_.data(), buffer_.size(), Clock::now() + timeouts_.read);
    } catch (...) {
      buffer_.clear();
      throw;
    }
    buffer_.resize(n);
  }
  const std::size_t n = std::min(size, buffer_.size());
  std::memcpy(into, buffer_.data(), n);
  buffer_.erase(0, n);
  return n;
}

std::size_t ClientStream::read_body(char* into, std::size_t size) { return body_ ? body_->read(into, size) : 0; }

ssize_t ClientStream::read(char* into, size_t size) {
  const std::size_t n = std::min(size, shown_.size());
  std::memcpy(into, shown_.data(), n);
  shown_.erase(0, n);
  return static_cast<ssize_t>(n);
}

bool ClientStream::is_writable() const { return !failed_ && wait_for(POLLOUT, Clock::now() + timeouts_.write); }

ssize_t ClientStream::write(const char* bytes, size_t size) {
  while (!failed_) {
    const ssize_t n = ::send(socket_.get(), bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n >= 0) return n;
    if (errno == EINTR) continue;
    if ((errno != EAGAIN && errno != EWOULDBLOCK) || !is_writable()) failed_ = true;
  }
  return -1;
}

void ClientStream::close_lingering() {
  ::shutdown(socket_.get(), SHUT_WR);
  const auto deadline = Clock::now() + std::chrono::seconds(1);
  char block[16384];
  std::uint64_t discarded = 0;
  while (discarded < (std::uint64_t{8} << 20) && wait_for(POLLIN, deadline)) {
    const ssize_t n = ::recv(socket_.get(), block, sizeof block, MSG_DONTWAIT);
    if (n <= 0) return;
    discarded += static_cast<std::uint64_t>(n);
  }
}

}  // namespace sheaf::server
