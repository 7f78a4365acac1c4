// SPDX-License-Identifier: MIT
#include "store/database.hpp"

#include "core/error.hpp"

namespace sheaf::server {
namespace {

constexpr int busy_ms = 5000;  // the two connections of a store meet only for moments

[[noreturn]] void fail(sqlite3* connection) {
  throw io_error("database", connection ? ::sqlite3_errmsg(connection) : "out of memory");
}

void check(sqlite3* connection, int result) {
  if (result != SQLITE_OK) fail(connection);
}

}  // namespace

Statement::Statement(sqlite3* connection, std::string_view sql) : connection_(connection) {
  sqlite3_stmt* statement = nullptr;
  check(connection, ::sqlite3_prepare_v2(connection, sql.data(), static_cast<int>(sql.size()), &statement, nullptr));
  statement_.reset(statement);
}

bool Statement::step() {
  const int result = ::sqlite3_step(statement_.get());
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) fail(connection_);
  return false;
}

void Statement::run() {
  while (step()) {
  }
}

std::string Statement::text(int column) const {
  const auto* bytes = static_cast<const char*>(::sqlite3_column_blob(statement_.get(), column));
  const int size = ::sqlite3_column_bytes(statement_.get(), column);
  return bytes ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
}

void Statement::put(std::int64_t value) { check(connection_, ::sqlite3_bind_int64(statement_.get(), ++bound_, value)); }
void Statement::put(double value) { check(connection_, ::sqlite3_bind_double(statement_.get(), ++bound_, value)); }
void Statement::put(const std::string& value) {
  check(connection_,
        ::sqlite3_bind_text64(statement_.get(), ++bound_, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}
void Statement::put(std::nullptr_t) { check(connection_, ::sqlite3_bind_null(statement_.get(), ++bound_)); }

Database::Database(const std::string& path) {
  sqlite3* connection = nullptr;
  const int result = ::sqlite3_open_v2(path.c_str(), &connection,
                                       SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  connection_.reset(connection);
  if (result != SQLITE_OK) throw io_error(path, connection ? ::sqlite3_errmsg(connection) : "out of memory");
  ::sqlite3_busy_timeout(connection, busy_ms);
  try {
    run("PRAGMA journal_mode = WAL");
    run("PRAGMA synchronous = FULL");
  } catch (const Error&) {
    throw io_error(path, ::sqlite3_errmsg(connection));
  }
}

Transaction::~Transaction() {
  if (!database_.in_transaction()) return;
  try {
    database_.run("ROLLBACK");
  } catch (const Error&) {
    // SQLite rolls back by itself when the next transaction begins or the file is opened again.
  }
}

}  // namespace sheaf::server
