// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <mutex>
#include <set>
#include <unordered_map>

#include "jobs/job_store.hpp"

namespace sheaf::server {

/// Jobs in memory: gone with the process.
class MemoryJobStore final : public JobStore {
 public:
  Submitted insert(Job job, const Idempotency& idempotency) override;
  [[nodiscard]] std::optional<Job> find(const std::string& id) const override;
  [[nodiscard]] Presence presence(const std::string& id) const override;
  [[nodiscard]] JobPage list(const JobQuery& query) const override;
  [[nodiscard]] std::map<JobState, std::uint64_t> count() const override;
  bool update(const std::string& id, const Change& change) override;
  [[nodiscard]] std::shared_ptr<EventLog> events(const std::string& id) const override;
  bool remove(const std::string& id) override;
  [[nodiscard]] std::vector<std::string> expired(WallTime now) const override;
  void interrupt_waits() override;

 private:
  struct Entry {
    Job job;
    std::shared_ptr<EventLog> events = std::make_shared<EventLog>();
    std::string idempotency_key;
  };
  struct Key {
    std::string fingerprint, id;
  };

  mutable std::mutex mutex_;
  std::uint64_t last_sequence_ = 0;
  std::map<std::uint64_t, Entry> jobs_;  // by sequence
  std::unordered_map<std::string, std::uint64_t> sequence_of_;
  std::unordered_map<std::string, Key> keys_;
  std::set<std::string> removed_;
  std::deque<std::string> removed_order_;  // oldest first: the memory of removed jobs is bounded
};

}  // namespace sheaf::server
