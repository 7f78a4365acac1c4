// SPDX-License-Identifier: MIT
// SQLite as this service uses it: one connection, statements that bind and read by place, every failure Error{io}.
#pragma once

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace sheaf::server {

class Statement {
 public:
  Statement(sqlite3* connection, std::string_view sql);

  /// Parameters in order.
  template <typename... Values>
  Statement& bind(const Values&... values) {
    (put(values), ...);
    return *this;
  }

  /// To the next row; false after the last.
  [[nodiscard]] bool step();
  void run();  // a statement that gives no rows

  [[nodiscard]] std::int64_t integer(int column) const { return ::sqlite3_column_int64(statement_.get(), column); }
  [[nodiscard]] double real(int column) const { return ::sqlite3_column_double(statement_.get(), column); }
  [[nodiscard]] bool null(int column) const { return ::sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }
  [[nodiscard]] std::string text(int column) const;

 private:
  void put(std::int64_t value);
  void put(double value);
  void put(const std::string& value);
  void put(std::nullptr_t);
  template <typename Value>
  void put(const std::optional<Value>& value) {
    value ? put(*value) : put(nullptr);
  }

  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }
  };
  sqlite3* connection_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int bound_ = 0;
};

/// A connection. Not for two threads at once.
class Database {
 public:
  /// Opens or makes the file, with a write-ahead log whose every commit is synced.
  explicit Database(const std::string& path);

  [[nodiscard]] Statement prepare(std::string_view sql) { return {connection_.get(), sql}; }
  void run(std::string_view sql) { prepare(sql).run(); }
  [[nodiscard]] std::int64_t last_row() const { return ::sqlite3_last_insert_rowid(connection_.get()); }
  [[nodiscard]] bool in_transaction() const { return ::sqlite3_get_autocommit(connection_.get()) == 0; }

 private:
  struct Close {
    void operator()(sqlite3* connection) const { ::sqlite3_close_v2(connection); }
  };
  std::unique_ptr<sqlite3, Close> connection_;
};

/// All or nothing: rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(Database& database) : database_(database) { database_.run("BEGIN IMMEDIATE"); }
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() { database_.run("COMMIT"); }

 private:
  Database& database_;
};

}  // namespace sheaf::server
