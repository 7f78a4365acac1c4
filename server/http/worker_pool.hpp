// SPDX-License-Identifier: MIT
// The threads that serve connections. A client that blocks its thread (for the next bytes of a body, for room in its
// socket) is stalled. For each stalled thread the pool may start another one, so that `threads` of them are always
// available to other clients. When `max_stalled` clients are stalled and a connection waits, the one that has been
// stalled longest is cut off.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "http/connection.hpp"

namespace sheaf::server {

struct PoolOptions {
  std::size_t threads = 32;
  std::size_t max_stalled = 256;
  std::chrono::milliseconds patience{1000};  // a client stalled for less is not cut off
};

class WorkerPool : private StallObserver {
 public:
  /// Called on a thread of the pool. release() must be called before the connection is closed or passed on.
  using Serve = std::function<void(ConnectionPtr)>;

  WorkerPool(PoolOptions options, Serve serve);
  ~WorkerPool() override;

  void start();
  void add(ConnectionPtr connection);
  void release(int fd);

  /// To be called about once a second: joins ended threads, and cuts off stalled clients where others wait. True: a
  /// connection is still waiting, so call again soon.
  bool tick();

  /// Waits until nothing is being served, or until the deadline; then serves only what is already waiting.
  void drain(std::chrono::steady_clock::time_point deadline);
  void shut_down_sockets(int how);
  void join();

 private:
  using Clock = std::chrono::steady_clock;
  void work(std::uint64_t number);
  [[nodiscard]] ConnectionPtr next(std::uint64_t number);
  void grow();
  void grow_or_evict();
  [[nodiscard]] std::size_t running() const { return threads_.size() - ended_.size() - stalled_; }
  void on_stall(int fd) override;
  void on_resume(int fd) override;

  PoolOptions options_;
  Serve serve_;
  std::mutex mutex_;
  std::condition_variable ready_, drained_;
  std::deque<ConnectionPtr> waiting_;
  std::map<int, std::optional<Clock::time_point>> busy_;  // since when its client is stalled
  std::size_t stalled_ = 0;
  bool closed_ = false;  // threads end when nothing waits
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, std::thread> threads_;
  std::vector<std::uint64_t> ended_;  // to be joined
};

}  // namespace sheaf::server
