// SPDX-License-Identifier: MIT
// Jobs in SQLite. Unfinished ones are in memory as well, as immutable values that are replaced once their successor is
// on the disk: reading a job never waits for the disk, and never shows what a crash could undo.
#pragma once

#include <deque>
#include <mutex>
#include <unordered_map>

#include "jobs/job_store.hpp"
#include "store/database.hpp"

namespace sheaf::server {

class SqliteJobStore final : public JobStore {
 public:
  /// Opens or creates `path` and loads its unfinished jobs. Throws Error{io}.
  explicit SqliteJobStore(const std::string& path);

  Submitted insert(Job job, const Idempotency& idempotency) override;
  [[nodiscard]] std::optional<Job> find(const std::string& id) const override;
  [[nodiscard]] Presence presence(const std::string& id) const override;
  [[nodiscard]] std::string removal_reason(const std::string& id) const override;
  [[nodiscard]] JobPage list(const JobQuery& query) const override;
  [[nodiscard]] std::map<JobState, std::uint64_t> count() const override;
  [[nodiscard]] std::vector<std::string> unfinished() const override;
  bool update(const std::string& id, const Change& change, OnWriteError on_error = OnWriteError::keep) override;
  [[nodiscard]] std::shared_ptr<EventLog> events(const std::string& id) const override;
  bool remove(const std::string& id, const std::string& reason) override;
  [[nodiscard]] std::vector<std::string> expired(WallTime now) const override;
  [[nodiscard]] std::vector<std::string> over_quota(std::uint64_t bytes) const override;
  std::optional<std::string> write_error() override;
  void interrupt_waits() override;

 private:
  using JobPtr = std::shared_ptr<const Job>;
  struct Entry {
    JobPtr job, stored;  // stored: as the database has it
    std::shared_ptr<EventLog> events;
    std::uint64_t events_stored = 0;
  };

  [[nodiscard]] Entry* entry_of(const std::string& id);
  bool store(Entry& entry, const JobPtr& job, const std::vector<Event>& fresh, OnWriteError on_error);
  void retire_if_ended(const std::string& id);
  void remember(const JobPtr& job) const;

  // Locked in this order. Changes are made one at a time; reading needs only the other two.
  std::mutex changing_;
  mutable std::mutex reading_;
  mutable std::mutex shown_;

  Database writer_;          // under changing_
  mutable Database reader_;  // under reading_
  // Under shown_; written under changing_ as well, so that a change may read them with changing_ alone.
  std::unordered_map<std::string, Entry> active_;
  mutable std::deque<JobPtr> recent_;  // ended jobs that were read lately
  std::uint64_t removals_ = 0;
  std::string write_error_;
  bool interrupted_ = false;
};

}  // namespace sheaf::server
