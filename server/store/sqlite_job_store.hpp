// SPDX-License-Identifier: MIT
// Jobs in SQLite. Unfinished ones are in memory as well, as values that are never changed but replaced once their
// successor is on the disk: who looks at a job never waits for the disk, and never sees what a crash could take back.
#pragma once

#include <deque>
#include <mutex>
#include <unordered_map>

#include "jobs/job_store.hpp"
#include "store/database.hpp"

namespace sheaf::server {

class SqliteJobStore final : public JobStore {
 public:
  /// Opens or makes `path`; takes up the unfinished jobs that are in it. Throws Error{io}.
  explicit SqliteJobStore(const std::string& path);

  Submitted insert(Job job, const Idempotency& idempotency) override;
  [[nodiscard]] std::optional<Job> find(const std::string& id) const override;
  [[nodiscard]] Presence presence(const std::string& id) const override;
  [[nodiscard]] std::string removal_reason(const std::string& id) const override;
  [[nodiscard]] JobPage list(const JobQuery& query) const override;
  [[nodiscard]] std::map<JobState, std::uint64_t> count() const override;
  [[nodiscard]] std::vector<std::string> unfinished() const override;
  bool update(const std::string& id, const Change& change, IfUnstored unstored = IfUnstored::keep) override;
  [[nodiscard]] std::shared_ptr<EventLog> events(const std::string& id) const override;
  bool remove(const std::string& id, const std::string& reason) override;
  [[nodiscard]] std::vector<std::string> expired(WallTime now) const override;
  [[nodiscard]] std::vector<std::string> beyond(std::uint64_t bytes) const override;
  std::optional<std::string> trouble() override;
  void interrupt_waits() override;

 private:
  using JobPtr = std::shared_ptr<const Job>;
  struct Entry {
    JobPtr job, stored;  // stored: as the database has it
    std::shared_ptr<EventLog> events;
    std::uint64_t events_stored = 0;
  };

  [[nodiscard]] Entry* entry_of(const std::string& id);
  bool store(Entry& entry, const JobPtr& job, const std::vector<Event>& fresh, IfUnstored unstored);
  void retire_if_ended(const std::string& id);
  void remember(const JobPtr& job) const;

  // Taken in this order where several are. Changes are made one at a time; looking needs the other two alone.
  std::mutex changing_;
  mutable std::mutex reading_;
  mutable std::mutex shown_;

  Database writer_;          // under changing_
  mutable Database reader_;  // under reading_
  // Under shown_; written to under changing_ as well, so that a change may read them without.
  std::unordered_map<std::string, Entry> active_;
  mutable std::deque<JobPtr> recent_;  // ended ones that were looked at lately
  std::uint64_t removals_ = 0;
  std::string trouble_;
  bool interrupted_ = false;
};

}  // namespace sheaf::server
