// SPDX-License-Identifier: MIT
#include "store/job_rows.hpp"

#include <algorithm>

#include "core/error.hpp"
#include "store/job_record.hpp"

namespace sheaf::server {
namespace {

constexpr std::int64_t schema_version = 1;
constexpr std::int64_t remembered_removals = 100'000;  // older ones turn from 410 into 404

// warnings: apart from the record, which is written with every frame; numbers: of all frames, where they were known
// from the start; frames: only those that are rendered.
constexpr const char* tables[] = {
    "CREATE TABLE IF NOT EXISTS jobs (sequence INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE,"
    " state TEXT NOT NULL, scene TEXT NOT NULL, record TEXT NOT NULL, warnings TEXT NOT NULL, numbers TEXT NOT NULL, "
    "key TEXT UNIQUE,"
    " fingerprint TEXT, finished INTEGER, expires INTEGER, bytes INTEGER NOT NULL)",
    "CREATE INDEX IF NOT EXISTS jobs_by_state ON jobs (state, sequence)",
    "CREATE INDEX IF NOT EXISTS jobs_by_expiry ON jobs (expires)",
    "CREATE INDEX IF NOT EXISTS jobs_by_end ON jobs (finished, bytes)",  // sums and orders without reading records
    "CREATE TABLE IF NOT EXISTS frames (job INTEGER NOT NULL, number INTEGER NOT NULL, wall_ms REAL NOT NULL,"
    " exr TEXT NOT NULL, exr_bytes INTEGER NOT NULL, exr_crc32 INTEGER NOT NULL, exr_sha256 TEXT NOT NULL,"
    " png TEXT, png_bytes INTEGER, png_crc32 INTEGER, png_sha256 TEXT, PRIMARY KEY (job, number)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS events (job INTEGER NOT NULL, id INTEGER NOT NULL, type TEXT NOT NULL,"
    " time INTEGER NOT NULL, data TEXT NOT NULL, PRIMARY KEY (job, id)) WITHOUT ROWID",
    "CREATE TABLE IF NOT EXISTS removed (place INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE,"
    " reason TEXT NOT NULL)"};

std::int64_t signed64(std::uint64_t value) { return static_cast<std::int64_t>(value); }

std::optional<std::int64_t> milliseconds(const std::optional<WallTime>& time) {
  if (!time) return std::nullopt;
  return to_milliseconds(*time);
}

std::int64_t bytes_of(const Job& job) {
  std::uint64_t bytes = job.scene_bytes;
  for (const Frame& frame : job.frames)
    bytes += (frame.exr ? frame.exr->bytes : 0) + (frame.png ? frame.png->bytes : 0);
  return signed64(bytes);
}

std::string warnings_of(const JobSummary& job) {
  return nlohmann::json(job.warnings).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<std::string> warnings_at(const Statement& row, int column) {
  const auto json = nlohmann::json::parse(row.text(column), nullptr, false);
  std::vector<std::string> warnings;
  for (const auto& warning : json)
    if (warning.is_string()) warnings.push_back(warning.get<std::string>());
  return warnings;
}

std::string numbers_of(const Job& job) {
  nlohmann::json numbers = nlohmann::json::array();
  if (job.frames_known)
    for (const Frame& frame : job.frames) numbers.push_back(frame.number);
  return numbers.dump();
}

void insert_events(Database& database, std::int64_t sequence, const std::vector<Event>& events) {
  for (const Event& event : events)
    database.prepare("INSERT INTO events VALUES (?, ?, ?, ?, ?)")
        .bind(sequence, signed64(event.id), event.type, to_milliseconds(event.time),
              event.data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace))
        .run();
}

void put_frame(Database& database, std::int64_t sequence, const Frame& frame) {
  Statement statement = database.prepare("INSERT OR REPLACE INTO frames VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  statement.bind(sequence, frame.number, frame.wall_ms, frame.exr->name, signed64(frame.exr->bytes),
                 std::int64_t{frame.exr->crc32}, frame.exr->sha256);
  if (frame.png)
    statement.bind(frame.png->name, signed64(frame.png->bytes), std::int64_t{frame.png->crc32}, frame.png->sha256);
  statement.run();
}

/// Files are never changed in place, so that equal pointers mean equal frames.
void update_frames(Database& database, const Job& old, const Job& job) {
  const auto sequence = signed64(job.sequence);
  auto before = old.frames.begin();
  for (const Frame& frame : job.frames) {
    while (before != old.frames.end() && before->number < frame.number) ++before;
    const Frame* const was = before != old.frames.end() && before->number == frame.number ? &*before : nullptr;
    if (frame.exr && (!was || was->exr != frame.exr || was->png != frame.png)) put_frame(database, sequence, frame);
    if (!frame.exr && was && was->exr)
      database.prepare("DELETE FROM frames WHERE job = ? AND number = ?").bind(sequence, frame.number).run();
  }
}

StoredFilePtr file_at(const Statement& row, int column) {
  if (row.null(column)) return nullptr;
  return std::make_shared<StoredFile>(StoredFile{row.text(column), static_cast<std::uint64_t>(row.integer(column + 1)),
                                                 static_cast<std::uint32_t>(row.integer(column + 2)),
                                                 row.text(column + 3)});
}

void load_frames(Database& database, const std::string& numbers, Job& job) {
  const auto known = nlohmann::json::parse(numbers, nullptr, false);
  for (const auto& number : known)
    if (number.is_number_integer()) job.frames.push_back({number.get<std::int64_t>(), {}, {}, 0});
  Statement row = database.prepare(
      "SELECT number, wall_ms, exr, exr_bytes, exr_crc32, exr_sha256, png, png_bytes, png_crc32, png_sha256"
      " FROM frames WHERE job = ? ORDER BY number");
  row.bind(signed64(job.sequence));
  while (row.step()) {
    const Frame frame{row.integer(0), file_at(row, 2), file_at(row, 6), row.real(1)};
    if (Frame* const there = find_frame(job.frames, frame.number))
      *there = frame;
    else
      job.frames.push_back(frame);  // in order: where the numbers are not known there are no others
  }
}

}  // namespace

void prepare_tables(Database& database) {
  Statement version = database.prepare("PRAGMA user_version");
  if (version.step() && version.integer(0) > schema_version)
    throw io_error("database", "was written by a newer sheafd (version " + std::to_string(version.integer(0)) + ")");
  for (const char* table : tables) database.run(table);
  database.run("PRAGMA user_version = " + std::to_string(schema_version));
}

void insert_job(Database& database, Job& job, const Idempotency& idempotency, const std::vector<Event>& events) {
  const bool keyed = !idempotency.key.empty();
  database
      .prepare(
          "INSERT INTO jobs (id, state, scene, record, warnings, numbers, key, fingerprint, finished, expires, bytes)"
          " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(job.id, std::string(name_of(job.state)), job.scene_file, to_record(job), warnings_of(job), numbers_of(job),
            keyed ? std::optional(idempotency.key) : std::nullopt, idempotency.fingerprint, milliseconds(job.finished),
            milliseconds(job.expires), bytes_of(job))
      .run();
  job.sequence = static_cast<std::uint64_t>(database.last_row());
  insert_events(database, signed64(job.sequence), events);
}

void update_job(Database& database, const Job& old, const Job& job, const std::vector<Event>& events) {
  database.prepare("UPDATE jobs SET state = ?, record = ?, finished = ?, expires = ?, bytes = ? WHERE sequence = ?")
      .bind(std::string(name_of(job.state)), to_record(job), milliseconds(job.finished), milliseconds(job.expires),
            bytes_of(job), signed64(job.sequence))
      .run();
  if (old.warnings != job.warnings)
    database.prepare("UPDATE jobs SET warnings = ? WHERE sequence = ?")
        .bind(warnings_of(job), signed64(job.sequence))
        .run();
  update_frames(database, old, job);
  insert_events(database, signed64(job.sequence), events);
}

bool remove_job(Database& database, const std::string& id, const std::string& reason) {
  Statement found = database.prepare("SELECT sequence FROM jobs WHERE id = ?");
  if (!found.bind(id).step()) return false;
  const std::int64_t sequence = found.integer(0);
  for (const char* statement :
       {"DELETE FROM events WHERE job = ?", "DELETE FROM frames WHERE job = ?", "DELETE FROM jobs WHERE sequence = ?"})
    database.prepare(statement).bind(sequence).run();
  database.prepare("INSERT OR REPLACE INTO removed (id, reason) VALUES (?, ?)").bind(id, reason).run();
  database.prepare("DELETE FROM removed WHERE place <= ?").bind(database.last_row() - remembered_removals).run();
  return true;
}

std::optional<Job> load_job(Database& database, const std::string& id) {
  Statement row = database.prepare("SELECT sequence, state, scene, record, numbers, warnings FROM jobs WHERE id = ?");
  if (!row.bind(id).step()) return std::nullopt;
  Job job;
  job.id = id;
  job.sequence = static_cast<std::uint64_t>(row.integer(0));
  job.state = job_state_of(row.text(1)).value_or(JobState::failed);
  job.scene_file = row.text(2);
  from_record(row.text(3), job);
  job.warnings = warnings_at(row, 5);
  load_frames(database, row.text(4), job);
  return job;
}

std::vector<Event> load_events(Database& database, const std::string& id) {
  Statement row = database.prepare(
      "SELECT events.id, type, data, time FROM events JOIN jobs ON events.job = jobs.sequence"
      " WHERE jobs.id = ? ORDER BY events.id");
  row.bind(id);
  std::vector<Event> events;
  while (row.step())
    events.push_back({static_cast<std::uint64_t>(row.integer(0)), row.text(1),
                      nlohmann::ordered_json::parse(row.text(2), nullptr, false), from_milliseconds(row.integer(3))});
  return events;
}

std::vector<std::string> unfinished_jobs(Database& database) {
  Statement row = database.prepare("SELECT id FROM jobs WHERE state IN ('queued', 'running') ORDER BY sequence");
  std::vector<std::string> ids;
  while (row.step()) ids.push_back(row.text(0));
  return ids;
}

JobPage load_page(Database& database, const JobQuery& query) {
  const std::string state = query.state ? " AND state = '" + std::string(name_of(*query.state)) + "'" : "";
  Statement row = database.prepare("SELECT sequence, state, scene, record, id, warnings FROM jobs WHERE sequence < ?" +
                                   state + " ORDER BY sequence DESC LIMIT ?");
  const std::uint64_t before = std::min<std::uint64_t>(query.before.value_or(INT64_MAX), INT64_MAX);
  row.bind(signed64(before), signed64(query.limit + 1));
  JobPage page;
  while (row.step()) {
    if (page.jobs.size() == query.limit) {
      page.next = page.jobs.back().sequence;
      break;
    }
    JobSummary job;
    job.sequence = static_cast<std::uint64_t>(row.integer(0));
    job.state = job_state_of(row.text(1)).value_or(JobState::failed);
    job.scene_file = row.text(2);
    from_record(row.text(3), job);
    job.id = row.text(4);
    job.warnings = warnings_at(row, 5);
    page.jobs.push_back(std::move(job));
  }
  return page;
}

}  // namespace sheaf::server
