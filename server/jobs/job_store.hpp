// SPDX-License-Identifier: MIT
// Where jobs are kept. The service uses nothing but this interface. Every call is atomic and safe from any thread; what
// it changes is on the disk before anybody can see it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "jobs/event_log.hpp"
#include "jobs/job.hpp"

namespace sheaf::server {

struct Idempotency {
  std::string key;          // empty: none
  std::string fingerprint;  // of the request's meaning
};

struct Submitted {
  enum class Kind { created, repeated, conflict } kind = Kind::created;
  std::string id;  // the new job's, or the earlier one's under the same key
};

struct JobQuery {
  std::optional<JobState> state;
  std::optional<std::uint64_t> before;  // sequence: only older ones
  std::size_t limit = 50;
};

struct JobPage {
  std::vector<JobSummary> jobs;       // newest first
  std::optional<std::uint64_t> next;  // where the following page starts
};

enum class Presence { unknown, present, removed };

/// What to do with a change that cannot be written now. `keep`: it stays in memory and is written as soon as possible
/// (a worker's results, which cannot be undone). `refuse`: Error{io}, and nothing changes.
enum class OnWriteError { keep, refuse };

class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Adds `job` under its id and gives it a sequence, unless the key names an earlier job that is still there.
  virtual Submitted insert(Job job, const Idempotency& idempotency) = 0;

  [[nodiscard]] virtual std::optional<Job> find(const std::string& id) const = 0;
  [[nodiscard]] virtual Presence presence(const std::string& id) const = 0;
  [[nodiscard]] virtual std::string removal_reason(const std::string& id) const = 0;
  [[nodiscard]] virtual JobPage list(const JobQuery& query) const = 0;
  [[nodiscard]] virtual std::map<JobState, std::uint64_t> count() const = 0;

  /// Queued and running ones, in order of submission.
  [[nodiscard]] virtual std::vector<std::string> unfinished() const = 0;

  /// Runs `change` on an unfinished job, one change at a time; false if it is not there or has ended. `change` may add
  /// to `events`.
  using Change = std::function<void(Job& job, NewEvents& events)>;
  virtual bool update(const std::string& id, const Change& change, OnWriteError on_error = OnWriteError::keep) = 0;

  /// The job's events: shared, and still readable after the job was removed.
  [[nodiscard]] virtual std::shared_ptr<EventLog> events(const std::string& id) const = 0;

  /// Removes the job and remembers that it existed. False if there is no such job.
  virtual bool remove(const std::string& id, const std::string& reason) = 0;

  /// Jobs whose retention has ended at `now`.
  [[nodiscard]] virtual std::vector<std::string> expired(WallTime now) const = 0;

  /// The jobs that ended first, as many as must go for the rest to have at most `bytes`.
  [[nodiscard]] virtual std::vector<std::string> over_quota(std::uint64_t bytes) const = 0;

  /// Why nothing can be written; nothing if it can. Writes what could not be written before.
  virtual std::optional<std::string> write_error() = 0;

  /// Wakes everybody who waits for events: the service stops.
  virtual void interrupt_waits() = 0;
};

}  // namespace sheaf::server
