// A small interface to SQLite. This is the only place that uses SQLite (docs/api.md, "What is kept").
//
//     Transaction transaction(database);
//     if (!transaction.begun()) return transaction.begun();
//     auto changed = database.Run("DELETE FROM keys WHERE id = ?", {id});
//     return changed ? transaction.Commit() : Result<void>(changed.error());
//
//  1. A Database may be used from many threads. A statement has exclusive use of it while it runs, and a
//     Transaction from its start to its end.
//  2. Committed changes are on the disk when Commit, or Run outside of a transaction, returns (write-ahead
//     log, synchronous=FULL). After a crash of the process or the machine, the database is in the state of
//     the last commit.
//  3. A failed statement changes nothing. A Transaction that ends without Commit is rolled back.
//  4. Errors: kWriteFailed (the disk is full or fails), kFormatBroken (the file is damaged or is not a
//     database), and kInternal for all others.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "render/base/result.h"

namespace facetless {

using SqlValue = std::variant<std::nullptr_t, std::int64_t, double, std::string>;

// The current row of a query. Columns are counted from 0.
class SqlRow {
 public:
  explicit SqlRow(void* statement) : statement_(statement) {}
  bool IsNull(int column) const;
  std::int64_t Integer(int column) const;  // 0 for null
  double Real(int column) const;           // 0 for null
  std::string Text(int column) const;      // "" for null

 private:
  void* statement_;
};

class Database {
 public:
  // Opens the file, and creates it if it is absent.
  static Result<std::unique_ptr<Database>> Open(const std::string& path);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // Runs one statement, and returns the number of rows that it changed.
  Result<int> Run(const std::string& sql, const std::vector<SqlValue>& values = {});
  // Calls `row` for each row of the result. `row` must not use the database.
  Result<void> Query(const std::string& sql, const std::vector<SqlValue>& values,
                     const std::function<void(const SqlRow&)>& row);
  // Runs several statements without values, given as one text.
  Result<void> RunScript(const std::string& sql);

 private:
  friend class Transaction;
  struct State;
  explicit Database(std::unique_ptr<State> state);
  Error LastError(const std::string& what) const;

  std::unique_ptr<State> state_;
};

class Transaction {
 public:
  // Locks the database and begins a transaction. begun() has the error if that fails.
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  const Result<void>& begun() const { return begun_; }
  Result<void> Commit();

 private:
  Database& database_;
  std::unique_lock<std::recursive_mutex> lock_;
  Result<void> begun_;
  bool open_ = false;
};

}  // namespace facetless
