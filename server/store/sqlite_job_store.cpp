// SPDX-License-Identifier: MIT
#include "store/sqlite_job_store.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "store/job_record.hpp"
#include "store/job_rows.hpp"
#include "util/log.hpp"

namespace sheaf::server {
namespace {

constexpr std::size_t recent_jobs = 32;  // a client that fetches a job's frames asks for the job with each

Database prepared(const std::string& path) {
  Database database(path);
  Transaction transaction(database);
  prepare_tables(database);
  transaction.commit();
  return database;
}

std::vector<std::string> ids_of(Statement& rows) {
  std::vector<std::string> ids;
  while (rows.step()) ids.push_back(rows.text(0));
  return ids;
}

}  // namespace

SqliteJobStore::SqliteJobStore(const std::string& path) : writer_(prepared(path)), reader_(path) {
  for (const std::string& id : unfinished_jobs(writer_)) {
    std::optional<Job> job = load_job(writer_, id);
    if (!job) continue;
    std::vector<Event> events = load_events(writer_, id);
    const std::uint64_t count = events.size();
    auto shared = std::make_shared<const Job>(*std::move(job));
    active_[id] = {shared, shared, std::make_shared<EventLog>(std::move(events), false), count};
  }
}

Submitted SqliteJobStore::insert(Job job, const Idempotency& idempotency) {
  const std::lock_guard changing(changing_);
  if (!idempotency.key.empty()) {
    Statement found = writer_.prepare("SELECT id, fingerprint FROM jobs WHERE key = ?");
    if (found.bind(idempotency.key).step()) {
      const bool same = found.text(1) == idempotency.fingerprint;
      return {same ? Submitted::Kind::repeated : Submitted::Kind::conflict, found.text(0)};
    }
  }
  NewEvents events(0);
  events.append("state", {{"state", name_of(job.state)}});
  try {
    Transaction transaction(writer_);
    insert_job(writer_, job, idempotency, events.list());
    transaction.commit();
  } catch (const Error& error) {
    const std::lock_guard shown(shown_);
    write_error_ = error.what();
    throw;
  }
  auto shared = std::make_shared<const Job>(std::move(job));
  auto log = std::make_shared<EventLog>(events.list(), false);
  const std::lock_guard shown(shown_);
  write_error_.clear();
  if (interrupted_) log->interrupt();
  active_[shared->id] = {shared, shared, std::move(log), events.list().size()};
  return {Submitted::Kind::created, shared->id};
}

std::optional<Job> SqliteJobStore::find(const std::string& id) const {
  std::uint64_t removals = 0;
  JobPtr known;
  {
    const std::lock_guard shown(shown_);
    if (const auto found = active_.find(id); found != active_.end())
      known = found->second.job;
    else if (const auto recent = std::ranges::find(recent_, id, [](const JobPtr& job) { return job->id; });
             recent != recent_.end())
      known = *recent;
    removals = removals_;
  }
  if (known) return *known;  // copied while nobody waits: a job may have very many frames
  std::optional<Job> job;
  {
    const std::lock_guard reading(reading_);
    job = load_job(reader_, id);
  }
  const std::lock_guard shown(shown_);
  if (job && is_finished(job->state) && removals == removals_) remember(std::make_shared<const Job>(*job));
  return job;
}

void SqliteJobStore::remember(const JobPtr& job) const {
  recent_.push_front(job);
  if (recent_.size() > recent_jobs) recent_.pop_back();
}

Presence SqliteJobStore::presence(const std::string& id) const {
  {
    const std::lock_guard shown(shown_);
    if (active_.contains(id)) return Presence::present;
  }
  const std::lock_guard reading(reading_);
  if (reader_.prepare("SELECT 1 FROM jobs WHERE id = ?").bind(id).step()) return Presence::present;
  const bool removed = reader_.prepare("SELECT 1 FROM removed WHERE id = ?").bind(id).step();
  return removed ? Presence::removed : Presence::unknown;
}

std::string SqliteJobStore::removal_reason(const std::string& id) const {
  const std::lock_guard reading(reading_);
  Statement row = reader_.prepare("SELECT reason FROM removed WHERE id = ?");
  return row.bind(id).step() ? row.text(0) : "was removed";
}

JobPage SqliteJobStore::list(const JobQuery& query) const {
  const std::lock_guard reading(reading_);
  return load_page(reader_, query);
}

std::map<JobState, std::uint64_t> SqliteJobStore::count() const {
  std::map<JobState, std::uint64_t> counts{{JobState::queued, 0},
                                           {JobState::running, 0},
                                           {JobState::done, 0},
                                           {JobState::failed, 0},
                                           {JobState::cancelled, 0}};
  const std::lock_guard reading(reading_);
  Statement row = reader_.prepare("SELECT state, count(*) FROM jobs GROUP BY state");
  while (row.step())
    if (const auto state = job_state_of(row.text(0))) counts[*state] = static_cast<std::uint64_t>(row.integer(1));
  return counts;
}

std::vector<std::string> SqliteJobStore::unfinished() const {
  const std::lock_guard reading(reading_);
  return unfinished_jobs(reader_);
}

SqliteJobStore::Entry* SqliteJobStore::entry_of(const std::string& id) {
  const auto found = active_.find(id);
  return found == active_.end() ? nullptr : &found->second;
}

/// True once `job` and every event is in the database.
bool SqliteJobStore::store(Entry& entry, const JobPtr& job, const std::vector<Event>& fresh, OnWriteError on_error) {
  std::string reason;
  try {
    std::vector<Event> events = entry.events->read(entry.events_stored, SIZE_MAX).events;
    events.insert(events.end(), fresh.begin(), fresh.end());
    Transaction transaction(writer_);
    update_job(writer_, *entry.stored, *job, events);
    transaction.commit();
    entry.stored = job;
    entry.events_stored += events.size();
  } catch (const Error& error) {
    reason = error.what();
  }
  const std::lock_guard shown(shown_);
  if (write_error_.empty() && !reason.empty())
    write_log(LogLevel::error, "cannot store", {{"job", job->id}, {"reason", reason}});
  write_error_ = reason;
  if (!reason.empty() && on_error == OnWriteError::refuse) throw Error(ErrorKind::io, reason);
  return reason.empty();
}

/// An ended job stays in memory only until the database has its end.
void SqliteJobStore::retire_if_ended(const std::string& id) {
  const std::lock_guard shown(shown_);
  const Entry* const entry = entry_of(id);
  if (!entry || !is_finished(entry->job->state) || entry->stored != entry->job) return;
  remember(entry->job);
  active_.erase(id);
}

bool SqliteJobStore::update(const std::string& id, const Change& change, OnWriteError on_error) {
  const std::lock_guard changing(changing_);
  Entry* const entry = entry_of(id);
  if (!entry || is_finished(entry->job->state)) return false;
  auto next = std::make_shared<Job>(*entry->job);
  NewEvents events(entry->events->size());
  change(*next, events);
  store(*entry, next, events.list(), on_error);
  {
    const std::lock_guard shown(shown_);
    entry->job = next;
  }
  entry->events->publish(events.list(), events.closed());
  retire_if_ended(id);
  return true;
}

std::shared_ptr<EventLog> SqliteJobStore::events(const std::string& id) const {
  {
    const std::lock_guard shown(shown_);
    if (const auto found = active_.find(id); found != active_.end()) return found->second.events;
  }
  const std::lock_guard reading(reading_);
  std::vector<Event> events = load_events(reader_, id);
  return events.empty() ? nullptr : std::make_shared<EventLog>(std::move(events), true);
}

bool SqliteJobStore::remove(const std::string& id, const std::string& reason) {
  const std::lock_guard changing(changing_);
  try {
    Transaction transaction(writer_);
    if (!remove_job(writer_, id, reason)) return false;
    transaction.commit();
  } catch (const Error& error) {
    const std::lock_guard shown(shown_);
    write_error_ = error.what();
    throw;
  }
  const std::lock_guard shown(shown_);
  ++removals_;
  std::erase_if(recent_, [&](const JobPtr& job) { return job->id == id; });
  if (Entry* const entry = entry_of(id)) {
    entry->events->close();
    active_.erase(id);
  }
  return true;
}

std::vector<std::string> SqliteJobStore::expired(WallTime now) const {
  const std::lock_guard reading(reading_);
  Statement rows = reader_.prepare("SELECT id FROM jobs WHERE expires <= ?");
  return ids_of(rows.bind(to_milliseconds(now)));
}

std::vector<std::string> SqliteJobStore::over_quota(std::uint64_t bytes) const {
  const std::lock_guard reading(reading_);
  Statement total = reader_.prepare("SELECT coalesce(sum(bytes), 0) FROM jobs");
  std::int64_t excess = total.step() ? total.integer(0) - static_cast<std::int64_t>(bytes) : 0;
  if (excess <= 0) return {};
  Statement row = reader_.prepare("SELECT id, bytes FROM jobs WHERE finished IS NOT NULL ORDER BY finished");
  std::vector<std::string> ids;
  for (; excess > 0 && row.step(); excess -= row.integer(1)) ids.push_back(row.text(0));
  return ids;
}

std::optional<std::string> SqliteJobStore::write_error() {
  {
    const std::lock_guard shown(shown_);
    if (write_error_.empty()) return std::nullopt;
  }
  const std::lock_guard changing(changing_);
  std::vector<std::string> ids;
  for (const auto& [id, entry] : active_)
    if (entry.stored != entry.job) ids.push_back(id);
  for (const std::string& id : ids)
    if (store(*entry_of(id), entry_of(id)->job, {}, OnWriteError::keep)) retire_if_ended(id);
  std::string reason;
  try {  // a write, whether or not there was anything to be stored
    Transaction transaction(writer_);
    writer_.run("PRAGMA user_version = 1");
    transaction.commit();
  } catch (const Error& error) {
    reason = error.what();
  }
  const std::lock_guard shown(shown_);
  write_error_ = reason;
  return reason.empty() ? std::nullopt : std::optional(reason);
}

void SqliteJobStore::interrupt_waits() {
  const std::lock_guard shown(shown_);
  interrupted_ = true;
  for (const auto& [id, entry] : active_) entry.events->interrupt();
}

}  // namespace sheaf::server
