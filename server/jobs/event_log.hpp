// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "util/clock.hpp"

namespace sheaf::server {

struct Event {
  std::uint64_t id = 0;  // 1, 2, 3, … within a job
  std::string type;      // state, start, frame, warning
  nlohmann::ordered_json data;
  WallTime time;
};

/// What happened to one job, in order; kept whole, so that a client that comes late or back misses nothing.
/// Safe to use from several threads.
class EventLog {
 public:
  /// Nothing is added after close().
  void append(const std::string& type, nlohmann::ordered_json data);

  /// The job has ended or was removed: no event will follow.
  void close();

  struct Batch {
    std::vector<Event> events;
    bool ended = false;  // and no more will come
  };

  /// Events after `after`, at most `most`, at once.
  [[nodiscard]] Batch read(std::uint64_t after, std::size_t most) const;

  /// Waits until there is one, the log is closed, or the deadline passes.
  [[nodiscard]] Batch wait(std::uint64_t after, std::size_t most, std::chrono::steady_clock::time_point deadline) const;

  /// Lets every wait() return now and from now on: the service stops.
  void interrupt();
  [[nodiscard]] bool interrupted() const;

 private:
  [[nodiscard]] Batch read_locked(std::uint64_t after, std::size_t most) const;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::vector<Event> events_;
  bool closed_ = false, interrupted_ = false;
};

}  // namespace sheaf::server
