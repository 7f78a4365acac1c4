// SPDX-License-Identifier: MIT
#include "http/worker_pool.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "util/log.hpp"

namespace sheaf::server {

WorkerPool::WorkerPool(PoolOptions options, Serve serve) : options_(options), serve_(std::move(serve)) {}

WorkerPool::~WorkerPool() { join(); }

void WorkerPool::start() {
  const std::lock_guard lock(mutex_);
  while (threads_.size() < options_.threads) grow();
}

/// Under the lock. If the system cannot start another thread, the pool goes on with those it has.
void WorkerPool::grow() {
  const std::uint64_t number = ++last_;
  try {
    threads_.emplace(number, std::thread([this, number] { work(number); }));
  } catch (const std::system_error& error) {
    if (threads_.size() == ended_.size()) throw;
    write_log(LogLevel::warning, "cannot start another thread",
              {{"threads", threads_.size()}, {"reason", error.what()}});
  }
}

void WorkerPool::add(ConnectionPtr connection) {
  connection->stream.observe_stalls(this);
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(connection));
    grow_or_evict();
  }
  ready_.notify_one();
}

/// Under the lock, when a connection waits: starts another thread, or cuts off the client that has been stalled
/// longest.
void WorkerPool::grow_or_evict() {
  if (closed_ || waiting_.empty() || running() >= options_.threads) return;
  if (stalled_ < options_.max_stalled) return grow();
  const auto first = std::ranges::min_element(
      busy_, {}, [](const auto& entry) { return entry.second.value_or(Clock::time_point::max()); });
  if (first == busy_.end() || !first->second || Clock::now() - *first->second < options_.patience) return;
  ::shutdown(first->first, SHUT_RDWR);  // its thread gets an error and ends; not to be chosen again
  first->second.reset();
  --stalled_;
}

void WorkerPool::release(int fd) {
  const std::lock_guard lock(mutex_);
  const auto found = busy_.find(fd);
  if (found == busy_.end()) return;
  if (found->second) --stalled_;
  busy_.erase(found);
  drained_.notify_all();
}

void WorkerPool::on_stall(int fd) {
  const std::lock_guard lock(mutex_);
  const auto found = busy_.find(fd);
  if (found == busy_.end() || found->second) return;
  found->second = Clock::now();
  ++stalled_;
  grow_or_evict();
}

void WorkerPool::on_resume(int fd) {
  const std::lock_guard lock(mutex_);
  const auto found = busy_.find(fd);
  if (found == busy_.end() || !found->second) return;
  found->second.reset();
  --stalled_;
}

ConnectionPtr WorkerPool::next(std::uint64_t number) {
  std::unique_lock lock(mutex_);
  if (waiting_.empty() && !closed_ && running() > options_.threads) {  // fewer clients are stalled than before
    ended_.push_back(number);
    return nullptr;
  }
  ready_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
  if (waiting_.empty()) return nullptr;
  ConnectionPtr connection = std::move(waiting_.front());
  waiting_.pop_front();
  busy_[connection->stream.fd()] = std::nullopt;
  return connection;
}

void WorkerPool::work(std::uint64_t number) {
  while (ConnectionPtr connection = next(number)) serve_(std::move(connection));
}

bool WorkerPool::tick() {
  std::vector<std::thread> gone;
  bool waited_for = false;
  {
    const std::lock_guard lock(mutex_);
    for (const std::uint64_t number : std::exchange(ended_, {}))
      gone.push_back(std::move(threads_.extract(number).mapped()));
    for (std::size_t i = 0; i < waiting_.size(); ++i) grow_or_evict();
    waited_for = !waiting_.empty();
  }
  for (std::thread& thread : gone) thread.join();
  return waited_for;
}

void WorkerPool::drain(Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  drained_.wait_until(lock, deadline, [this] { return busy_.empty() && waiting_.empty(); });
  closed_ = true;
}

void WorkerPool::shut_down_sockets(int how) {
  const std::lock_guard lock(mutex_);
  for (const auto& [fd, stalled] : busy_) ::shutdown(fd, how);
  for (const auto& connection : waiting_) ::shutdown(connection->stream.fd(), how);
}

void WorkerPool::join() {
  std::map<std::uint64_t, std::thread> threads;
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    threads.swap(threads_);
    ended_.clear();
  }
  ready_.notify_all();
  for (auto& [number, thread] : threads) thread.join();
}

}  // namespace sheaf::server
