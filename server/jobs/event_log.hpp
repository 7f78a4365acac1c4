// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
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

/// Events to be added to a log: numbered, not yet visible.
class NewEvents {
 public:
  explicit NewEvents(std::uint64_t last) : last_(last) {}
  void append(const std::string& type, nlohmann::ordered_json data);
  void close() { closed_ = true; }  // no event will follow
  [[nodiscard]] const std::vector<Event>& list() const { return events_; }
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  std::uint64_t last_;
  std::vector<Event> events_;
  bool closed_ = false;
};

/// All events of one job, in order; kept, so that a client that connects late or again misses none.
/// Safe to use from several threads.
class EventLog {
 public:
  EventLog() = default;
  EventLog(std::vector<Event> earlier, bool closed) : events_(std::move(earlier)), closed_(closed) {}

  /// Makes `events` visible; `last`: no event will follow.
  void publish(const std::vector<Event>& events, bool last);

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

  /// `wake` is called, under the log's lock, whenever wait() would return; until the result is gone.
  [[nodiscard]] std::shared_ptr<void> watch(std::function<void()> wake) const;

  /// Every wait() returns now and from now on: the service stops.
  void interrupt();
  [[nodiscard]] bool interrupted() const;
  [[nodiscard]] std::uint64_t size() const;

 private:
  void notify_watchers() const;
  [[nodiscard]] Batch read_locked(std::uint64_t after, std::size_t most) const;

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  mutable std::uint64_t last_watch_ = 0;
  mutable std::map<std::uint64_t, std::function<void()>> watches_;
  std::vector<Event> events_;
  bool closed_ = false, interrupted_ = false;
};

}  // namespace sheaf::server
