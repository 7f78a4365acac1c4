// SPDX-License-Identifier: MIT
// Sends lasting replies (event streams, long polls), all on one thread. Each is woken when its source has something to
// send or its deadline has passed, and is written as far as its client's socket has room. None can block another, or a
// thread that answers requests.
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "http/connection.hpp"
#include "http/message.hpp"

namespace sheaf::server {

class StreamPump {
 public:
  /// `done` receives the connection: with `keep` another request may follow on it.
  using Done = std::function<void(ConnectionPtr connection, const ExchangeRecord& record, bool keep)>;
  StreamPump(std::chrono::milliseconds write_timeout, Done done);
  ~StreamPump();
  StreamPump(const StreamPump&) = delete;
  StreamPump& operator=(const StreamPump&) = delete;

  struct LastingReply {
    ConnectionPtr connection;
    std::string head;  // of the reply, as it goes out
    LastingBody body;
    bool chunked = true, keep = true;
    ExchangeRecord record;
    std::chrono::steady_clock::time_point started;
  };
  void add(LastingReply reply);

  /// Lets replies end until `deadline`, then drops the rest. Nothing may be added afterwards.
  void stop(std::chrono::steady_clock::time_point deadline);

 private:
  using Clock = std::chrono::steady_clock;
  struct Stream {
    LastingReply reply;
    std::string out;  // written next
    std::shared_ptr<void> watch;
    Clock::time_point due, stuck_at;
    bool over = false, waits_for_room = false;
  };

  void wake(std::uint64_t number);
  void notify() const;
  void work();
  void take_arrivals(std::set<std::uint64_t>& ready);
  void run_stream(std::uint64_t number, Clock::time_point now);
  bool write_out(std::uint64_t number, Stream& stream);
  void finish(std::uint64_t number, bool whole);
  [[nodiscard]] Clock::time_point next_time() const;

  std::chrono::milliseconds write_timeout_;
  Done done_;
  Fd epoll_, event_;
  std::mutex mutex_;
  std::vector<std::pair<std::uint64_t, LastingReply>> arrived_;
  std::set<std::uint64_t> woken_;
  std::uint64_t last_ = 0;
  bool stopping_ = false;
  Clock::time_point deadline_;
  std::map<std::uint64_t, Stream> streams_;  // used by the thread alone
  std::thread thread_;
};

}  // namespace sheaf::server
