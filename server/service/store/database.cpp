#include "server/service/store/database.h"

#include <sqlite3.h>

#include <unordered_map>
#include <utility>

namespace facetless {
namespace {

// The time to wait for another connection that is writing. Commits take milliseconds.
constexpr int kBusyMs = 10000;

sqlite3_stmt* Statement(void* statement) {
  return static_cast<sqlite3_stmt*>(statement);
}

bool Bind(sqlite3_stmt* statement, int index, const SqlValue& value) {
  int code = SQLITE_OK;
  if (std::holds_alternative<std::nullptr_t>(value)) {
    code = sqlite3_bind_null(statement, index);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    code = sqlite3_bind_int64(statement, index, *integer);
  } else if (const auto* real = std::get_if<double>(&value)) {
    code = sqlite3_bind_double(statement, index, *real);
  } else {
    const std::string& text = std::get<std::string>(value);
    code = sqlite3_bind_text64(statement, index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  }
  return code == SQLITE_OK;
}

}  // namespace

bool SqlRow::IsNull(int column) const {
  return sqlite3_column_type(Statement(statement_), column) == SQLITE_NULL;
}
std::int64_t SqlRow::Integer(int column) const {
  return sqlite3_column_int64(Statement(statement_), column);
}
double SqlRow::Real(int column) const {
  return sqlite3_column_double(Statement(statement_), column);
}
std::string SqlRow::Text(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(Statement(statement_), column));
  const int bytes = sqlite3_column_bytes(Statement(statement_), column);
  return text == nullptr ? "" : std::string(text, static_cast<std::size_t>(bytes));
}

struct Database::State {
  std::string path;
  sqlite3* connection = nullptr;
  std::recursive_mutex mutex;
  // The prepared statements. There are few, because all are literals in the code.
  std::unordered_map<std::string, sqlite3_stmt*> statements;

  ~State() {
    for (const auto& [sql, statement] : statements) sqlite3_finalize(statement);
    sqlite3_close(connection);
  }
};

Database::Database(std::unique_ptr<State> state) : state_(std::move(state)) {}
Database::~Database() = default;

Error Database::LastError(const std::string& what) const {
  const int code = sqlite3_errcode(state_->connection) & 0xff;
  const std::string reason = state_->path + ": " + what + ": " + sqlite3_errmsg(state_->connection);
  switch (code) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_READONLY:
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
      return {ErrorCode::kWriteFailed, reason};
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {ErrorCode::kFormatBroken, reason};
    default:
      return {ErrorCode::kInternal, reason};
  }
}

Result<std::unique_ptr<Database>> Database::Open(const std::string& path) {
  std::unique_ptr<Database> database(new Database(std::make_unique<State>()));
  database->state_->path = path;
  if (sqlite3_open(path.c_str(), &database->state_->connection) != SQLITE_OK)
    return database->LastError("cannot be opened");
  sqlite3_busy_timeout(database->state_->connection, kBusyMs);
  if (auto set = database->RunScript("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;"); !set)
    return set.error();
  return database;
}

Result<void> Database::RunScript(const std::string& sql) {
  const std::lock_guard lock(state_->mutex);
  if (sqlite3_exec(state_->connection, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return LastError("cannot be changed");
}

Result<void> Database::Query(const std::string& sql, const std::vector<SqlValue>& values,
                             const std::function<void(const SqlRow&)>& row) {
  const std::lock_guard lock(state_->mutex);
  sqlite3_stmt*& statement = state_->statements[sql];
  if (statement == nullptr &&
      sqlite3_prepare_v2(state_->connection, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    return LastError("statement \"" + sql + "\"");
  bool bound = true;
  for (std::size_t i = 0; i < values.size(); ++i)
    bound = bound && Bind(statement, static_cast<int>(i) + 1, values[i]);
  int code = bound ? sqlite3_step(statement) : SQLITE_ERROR;
  for (; code == SQLITE_ROW; code = sqlite3_step(statement)) {
    if (row) row(SqlRow(statement));
  }
  Result<void> outcome;
  if (code != SQLITE_DONE) outcome = LastError("a statement failed");
  // The result of reset is ignored, because it reports the same error again.
  sqlite3_reset(statement);
  sqlite3_clear_bindings(statement);
  return outcome;
}

Result<int> Database::Run(const std::string& sql, const std::vector<SqlValue>& values) {
  const std::lock_guard lock(state_->mutex);
  if (auto done = Query(sql, values, nullptr); !done) return done.error();
  return sqlite3_changes(state_->connection);
}

Transaction::Transaction(Database& database) : database_(database), lock_(database.state_->mutex) {
  auto begun = database_.Run("BEGIN IMMEDIATE");
  if (!begun) {
    begun_ = begun.error();
    return;
  }
  open_ = true;
}

Transaction::~Transaction() {
  // A full disk may have ended the transaction already.
  if (open_ && sqlite3_get_autocommit(database_.state_->connection) == 0)
    (void)database_.RunScript("ROLLBACK");
}

Result<void> Transaction::Commit() {
  auto done = database_.Run("COMMIT");
  if (!done) return done.error();
  open_ = false;
  return {};
}

}  // namespace facetless
