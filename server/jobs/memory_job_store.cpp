// SPDX-License-Identifier: MIT
#include "jobs/memory_job_store.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t remembered_removals = 100'000;  // older ones turn from 410 into 404

}  // namespace

Submitted MemoryJobStore::insert(Job job, const Idempotency& idempotency) {
  const std::lock_guard lock(mutex_);
  if (!idempotency.key.empty()) {
    const auto found = keys_.find(idempotency.key);
    if (found != keys_.end()) {
      const bool same = found->second.fingerprint == idempotency.fingerprint;
      return {same ? Submitted::Kind::repeated : Submitted::Kind::conflict, found->second.id};
    }
    keys_[idempotency.key] = {idempotency.fingerprint, job.id};
  }
  job.sequence = ++last_sequence_;
  const std::string id = job.id;
  sequence_of_[id] = job.sequence;
  Entry& entry = jobs_[job.sequence];
  entry.job = std::move(job);
  entry.idempotency_key = idempotency.key;
  entry.events->append("state", {{"state", name_of(entry.job.state)}});
  return {Submitted::Kind::created, id};
}

std::optional<Job> MemoryJobStore::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sequence_of_.find(id);
  if (found == sequence_of_.end()) return std::nullopt;
  return jobs_.at(found->second).job;
}

Presence MemoryJobStore::presence(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  if (sequence_of_.contains(id)) return Presence::present;
  return removed_.contains(id) ? Presence::removed : Presence::unknown;
}

JobPage MemoryJobStore::list(const JobQuery& query) const {
  const std::lock_guard lock(mutex_);
  JobPage page;
  auto at = query.before ? jobs_.lower_bound(*query.before) : jobs_.end();
  while (at != jobs_.begin()) {
    --at;
    const Job& job = at->second.job;
    if (query.state && job.state != *query.state) continue;
    if (page.jobs.size() == query.limit) {
      page.next = page.jobs.back().sequence;
      break;
    }
    page.jobs.push_back(job);
  }
  return page;
}

std::map<JobState, std::uint64_t> MemoryJobStore::count() const {
  const std::lock_guard lock(mutex_);
  std::map<JobState, std::uint64_t> counts{{JobState::queued, 0},
                                           {JobState::running, 0},
                                           {JobState::done, 0},
                                           {JobState::failed, 0},
                                           {JobState::cancelled, 0}};
  for (const auto& [sequence, entry] : jobs_) ++counts[entry.job.state];
  return counts;
}

bool MemoryJobStore::update(const std::string& id, const Change& change) {
  const std::lock_guard lock(mutex_);
  const auto found = sequence_of_.find(id);
  if (found == sequence_of_.end()) return false;
  Entry& entry = jobs_.at(found->second);
  change(entry.job, *entry.events);
  return true;
}

std::shared_ptr<EventLog> MemoryJobStore::events(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sequence_of_.find(id);
  return found == sequence_of_.end() ? nullptr : jobs_.at(found->second).events;
}

bool MemoryJobStore::remove(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = sequence_of_.find(id);
  if (found == sequence_of_.end()) return false;
  Entry& entry = jobs_.at(found->second);
  entry.events->close();
  if (!entry.idempotency_key.empty()) keys_.erase(entry.idempotency_key);
  jobs_.erase(found->second);
  sequence_of_.erase(found);
  removed_.insert(id);
  removed_order_.push_back(id);
  if (removed_order_.size() > remembered_removals) {
    removed_.erase(removed_order_.front());
    removed_order_.pop_front();
  }
  return true;
}

std::vector<std::string> MemoryJobStore::expired(WallTime now) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [sequence, entry] : jobs_)
    if (entry.job.expires && *entry.job.expires <= now) ids.push_back(entry.job.id);
  return ids;
}

void MemoryJobStore::interrupt_waits() {
  const std::lock_guard lock(mutex_);
  for (const auto& [sequence, entry] : jobs_) entry.events->interrupt();
}

}  // namespace sheaf::server
