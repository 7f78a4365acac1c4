// SPDX-License-Identifier: MIT
#include "http/stream_pump.hpp"

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "core/error.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

constexpr std::uint64_t own_event = 0;  // streams are numbered from 1
constexpr auto longest_sleep = std::chrono::seconds(60);

std::string as_chunk(const std::string& text) {
  std::array<char, 20> size{};
  const auto end = std::to_chars(size.data(), size.data() + size.size(), text.size(), 16).ptr;
  return std::string(size.data(), end) + "\r\n" + text + "\r\n";
}

void watch(int epoll, int fd, std::uint64_t number, std::uint32_t events) {
  epoll_event event{};
  event.events = events;
  event.data.u64 = number;
  if (::epoll_ctl(epoll, EPOLL_CTL_MOD, fd, &event) != 0) ::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event);
}

}  // namespace

StreamPump::StreamPump(std::chrono::milliseconds write_timeout, Done done)
    : write_timeout_(write_timeout),
      done_(std::move(done)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!epoll_.valid() || !event_.valid()) throw io_error("epoll", std::strerror(errno));
  watch(epoll_.get(), event_.get(), own_event, EPOLLIN);
  thread_ = std::thread([this] { work(); });
}

StreamPump::~StreamPump() { stop(Clock::now()); }

void StreamPump::add(LastingReply reply) {
  {
    const std::lock_guard lock(mutex_);
    arrived_.emplace_back(++last_, std::move(reply));
  }
  notify();
}

void StreamPump::stop(Clock::time_point deadline) {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    deadline_ = deadline;
  }
  notify();
  if (thread_.joinable()) thread_.join();
}

void StreamPump::wake(std::uint64_t number) {
  {
    const std::lock_guard lock(mutex_);
    woken_.insert(number);
  }
  notify();
}

void StreamPump::notify() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t n = ::write(event_.get(), &one, sizeof one);
}

StreamPump::Clock::time_point StreamPump::next_time() const {
  Clock::time_point next = Clock::now() + longest_sleep;
  for (const auto& [number, stream] : streams_)
    next = std::min(next, stream.waits_for_room ? stream.stuck_at : stream.due);
  return next;
}

void StreamPump::work() {
  std::array<epoll_event, 256> events{};
  while (true) {
    Clock::time_point until = next_time();
    {
      const std::lock_guard lock(mutex_);
      if (stopping_ && ((streams_.empty() && arrived_.empty()) || Clock::now() >= deadline_)) break;
      if (stopping_) until = std::min(until, deadline_);
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
    const int n = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()),
                               static_cast<int>(std::max<long long>(left, 0)));
    std::set<std::uint64_t> ready;
    for (int i = 0; i < n; ++i) {
      const epoll_event& event = events[static_cast<std::size_t>(i)];
      if (event.data.u64 == own_event)
        take_arrivals(ready);
      else if (event.events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR))
        finish(event.data.u64, false);  // the client has gone
      else
        ready.insert(event.data.u64);
    }
    const Clock::time_point now = Clock::now();
    for (const auto& [number, stream] : streams_)
      if ((stream.waits_for_room ? stream.stuck_at : stream.due) <= now) ready.insert(number);
    for (const std::uint64_t number : ready) run_stream(number, now);
  }
  while (!streams_.empty()) finish(streams_.begin()->first, false);
}

void StreamPump::take_arrivals(std::set<std::uint64_t>& ready) {
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t n = ::read(event_.get(), &count, sizeof count);
  std::vector<std::pair<std::uint64_t, LastingReply>> arrived;
  {
    const std::lock_guard lock(mutex_);
    arrived.swap(arrived_);
    ready.merge(woken_);
    woken_.clear();
  }
  for (auto& [number, reply] : arrived) {
    Stream& stream = streams_[number];
    stream.reply = std::move(reply);
    stream.out = stream.reply.head;
    watch(epoll_.get(), stream.reply.connection->stream.fd(), number, EPOLLRDHUP);
    stream.watch = stream.reply.body.watch([this, number = number] { wake(number); });
    ready.insert(number);
  }
}

/// Writes what is pending; asks for more only when that is sent, so that a slow client costs one batch of memory.
void StreamPump::run_stream(std::uint64_t number, Clock::time_point now) {
  const auto found = streams_.find(number);
  if (found == streams_.end()) return;
  Stream& stream = found->second;
  if (stream.waits_for_room && stream.stuck_at <= now) return finish(number, false);
  while (true) {
    if (!write_out(number, stream)) return;
    if (stream.over) return finish(number, true);
    std::string text;
    stream.over = !stream.reply.body.advance(text);
    stream.due = stream.reply.body.due();
    if (!text.empty()) stream.out = stream.reply.chunked ? as_chunk(text) : text;
    if (stream.over && stream.reply.chunked) stream.out += "0\r\n\r\n";
    if (stream.out.empty() && !stream.over) return;
  }
}

/// True once everything is written; otherwise the stream waits for room, or has been finished.
bool StreamPump::write_out(std::uint64_t number, Stream& stream) {
  const int fd = stream.reply.connection->stream.fd();
  while (!stream.out.empty()) {
    const ssize_t n = ::send(fd, stream.out.data(), stream.out.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
      finish(number, false);
      return false;
    }
    if (n < 0) {
      if (!stream.waits_for_room) watch(epoll_.get(), fd, number, EPOLLRDHUP | EPOLLOUT);
      if (!stream.waits_for_room) stream.stuck_at = Clock::now() + write_timeout_;
      stream.waits_for_room = true;
      return false;
    }
    stream.out.erase(0, static_cast<std::size_t>(n));
    stream.stuck_at = Clock::now() + write_timeout_;
  }
  if (stream.waits_for_room) watch(epoll_.get(), fd, number, EPOLLRDHUP);
  stream.waits_for_room = false;
  return true;
}

void StreamPump::finish(std::uint64_t number, bool whole) {
  auto node = streams_.extract(number);
  if (node.empty()) return;
  Stream& stream = node.mapped();
  stream.watch.reset();
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, stream.reply.connection->stream.fd(), nullptr);
  stream.reply.record.seconds = Clock::now() - stream.reply.started;
  stream.reply.body = {};  // frees its slot before the client may ask again
  done_(std::move(stream.reply.connection), stream.reply.record, whole && stream.reply.keep);
}

}  // namespace sheaf::server
