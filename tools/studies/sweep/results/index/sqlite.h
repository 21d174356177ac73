#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "tools/studies/sweep/results/index/value.h"

struct sqlite3;
struct sqlite3_stmt;

namespace tools::results {

/// Words of SQLite when a statement failed.
struct SqliteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A prepared statement. Values are always bound, never part of its text.
class Statement {
 public:
  Statement(sqlite3* database, std::string_view sql);
  /// Numbers the `?` of the statement from 1.
  Statement& bind(int parameter, const Value& value);
  Statement& bind(int parameter, std::string_view text);
  Statement& bind(int parameter, const std::string& text) { return bind(parameter, std::string_view(text)); }
  Statement& bind(int parameter, std::int64_t number);
  /// The next row; false after the last. SqliteError if that fails.
  bool step();
  /// Runs it to its end, and makes it ready to be bound anew.
  void run();
  void reset();
  Value value(int column) const;
  std::int64_t number(int column) const;
  std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

/// A database in memory, to be written as a whole, or a file that is only read.
class Database {
 public:
  Database();
  /// Takes no lock: such files are replaced as a whole, never changed. SqliteError if it is no database.
  explicit Database(const std::filesystem::path& file);

  void run(const char* sql);
  Statement prepare(std::string_view sql) { return {database_.get(), sql}; }
  /// The bytes that a file of it would have.
  std::string bytes() const;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
};

}  // namespace tools::results
