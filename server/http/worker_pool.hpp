// SPDX-License-Identifier: MIT
// The threads that serve connections. A client that makes its thread wait (for a body's next bytes, for room in its
// socket) is stalled; for every stalled thread there may be one more, so that so many threads are always free for the
// others. At most `most_stalled` stay so: when that many are, and somebody waits, who has stalled longest is cut off.
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
  std::size_t most_stalled = 256;
  std::chrono::milliseconds patience{1000};  // a client that has stalled for less is not cut off
};

class WorkerPool : private StallObserver {
 public:
  /// Called on a thread of the pool. Before the connection is closed or given on, release() must have been called.
  using Serve = std::function<void(ConnectionPtr)>;

  WorkerPool(PoolOptions options, Serve serve);
  ~WorkerPool() override;

  void start();
  void add(ConnectionPtr connection);
  void release(int fd);

  /// To be called about once a second: ended threads are joined, and who stalls others cut off. True: somebody waits
  /// for that, so call again soon.
  bool tick();

  /// Waits until nothing is served any more, or the deadline; then serves only what waits already.
  void drain(std::chrono::steady_clock::time_point deadline);
  void shut_down_sockets(int how);
  void join();

 private:
  using Clock = std::chrono::steady_clock;
  void work(std::uint64_t number);
  [[nodiscard]] ConnectionPtr next(std::uint64_t number);
  void grow();
  void make_room();
  [[nodiscard]] std::size_t running() const { return threads_.size() - ended_.size() - stalled_; }
  void stalls(int fd) override;
  void goes_on(int fd) override;

  PoolOptions options_;
  Serve serve_;
  std::mutex mutex_;
  std::condition_variable ready_, drained_;
  std::deque<ConnectionPtr> waiting_;
  std::map<int, std::optional<Clock::time_point>> busy_;  // since when its client stalls
  std::size_t stalled_ = 0;
  bool closed_ = false;  // threads end when nothing waits
  std::uint64_t last_ = 0;
  std::map<std::uint64_t, std::thread> threads_;
  std::vector<std::uint64_t> ended_;  // to be joined
};

}  // namespace sheaf::server
