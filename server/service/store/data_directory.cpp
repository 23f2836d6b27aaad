#include "server/service/store/data_directory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "server/base/files.h"

namespace facetless {
namespace {

// The tables:
//   files   the files in DIR/files
//   uses    which item or job uses a file; the holder is an item or "job/<id>"
//   loose   files that have lost a user, which are candidates for deletion
//   totals  one row: the size of all files
//   items   models and answers, by "<owner>/model/<id>" and "<owner>/answer/<key>"
//   jobs    one row for each job, kept after its end
//   needs   the items that a waiting or running job needs
//   turns   when the jobs of an owner were last claimed, as a counter
//   keys    the access keys (keys.h)
constexpr const char* kSchema = R"(
CREATE TABLE files(sha256 TEXT PRIMARY KEY, bytes INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE totals(bytes INTEGER NOT NULL);
INSERT INTO totals VALUES(0);
CREATE TRIGGER file_came AFTER INSERT ON files BEGIN UPDATE totals SET bytes = bytes + NEW.bytes; END;
CREATE TRIGGER file_went AFTER DELETE ON files BEGIN UPDATE totals SET bytes = bytes - OLD.bytes; END;
CREATE TABLE uses(holder TEXT NOT NULL, role TEXT NOT NULL, file TEXT NOT NULL, PRIMARY KEY(holder, role)) WITHOUT ROWID;
CREATE INDEX uses_by_file ON uses(file);
CREATE TABLE loose(file TEXT PRIMARY KEY) WITHOUT ROWID;
CREATE TRIGGER use_went AFTER DELETE ON uses BEGIN INSERT OR IGNORE INTO loose VALUES(OLD.file); END;
CREATE TABLE items(id TEXT PRIMARY KEY, record TEXT NOT NULL, created REAL NOT NULL, used REAL NOT NULL);
CREATE INDEX items_by_use ON items(used);
CREATE TABLE jobs(number INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, kind TEXT NOT NULL, owner TEXT NOT NULL,
  question TEXT NOT NULL, request TEXT NOT NULL, state TEXT NOT NULL, created REAL NOT NULL, started REAL, finished REAL,
  attempts INTEGER NOT NULL, worker TEXT, lease REAL, cancelling INTEGER NOT NULL, result TEXT, problem TEXT, retry_key TEXT,
  body TEXT NOT NULL);
CREATE INDEX jobs_by_state ON jobs(state, owner, number);
CREATE INDEX jobs_by_end ON jobs(finished);
CREATE UNIQUE INDEX jobs_by_question ON jobs(owner, question) WHERE state IN ('queued', 'running');
CREATE UNIQUE INDEX jobs_by_retry_key ON jobs(owner, retry_key) WHERE retry_key IS NOT NULL;
CREATE TABLE needs(job TEXT NOT NULL, item TEXT NOT NULL, PRIMARY KEY(job, item)) WITHOUT ROWID;
CREATE INDEX needs_by_item ON needs(item);
CREATE TABLE turns(owner TEXT PRIMARY KEY, turn INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE keys(id TEXT PRIMARY KEY, name TEXT NOT NULL, digest TEXT NOT NULL, scopes TEXT NOT NULL, rate INTEGER NOT NULL,
  quota_mb INTEGER NOT NULL, created REAL NOT NULL, revoked REAL) WITHOUT ROWID;
)";

Result<void> MakeSchema(Database& database, const std::string& path) {
  // Create or upgrade the tables, and set the version, in one transaction, because another process may do the
  // same.
  Transaction transaction(database);
  if (!transaction.begun()) return transaction.begun();
  std::int64_t version = 0;
  auto asked =
      database.Query("PRAGMA user_version", {}, [&](const SqlRow& row) { version = row.Integer(0); });
  if (!asked) return asked;
  if (version == kSchemaVersion) return {};
  if (version > kSchemaVersion)
    return Error{ErrorCode::kBadUsage, path + " was written by a newer facetless (its version is " +
                                           std::to_string(version) + ", this program supports up to " +
                                           std::to_string(kSchemaVersion) +
                                           "); use the newer program, or choose another --data"};
  const std::string version_statement = "PRAGMA user_version = " + std::to_string(kSchemaVersion) + ";";
  if (auto made = database.RunScript(kSchema + version_statement); !made) return made;
  return transaction.Commit();
}

}  // namespace

Result<std::unique_ptr<DataDirectory>> DataDirectory::Open(const std::string& path) {
  for (const char* child : {"files", "tmp"}) {
    if (auto made = MakeDirectories(path + "/" + child); !made) return made.error();
  }
  const std::string lock_path = path + "/lock";
  const int lock = open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (lock < 0)
    return Error{ErrorCode::kWriteFailed, "cannot write " + lock_path + ": " + std::strerror(errno)};
  std::unique_ptr<DataDirectory> self(new DataDirectory(path, lock));
  if (flock(lock, LOCK_EX | LOCK_NB) != 0)
    return Error{ErrorCode::kBadUsage, path + " is in use by another facetless serve; choose another --data"};

  for (std::unique_ptr<Database>* connection : {&self->writer_, &self->reader_}) {
    auto opened = OpenDatabase(path);
    if (!opened) return opened.error();
    *connection = std::move(opened).value();
  }
  return self;
}

Result<std::unique_ptr<Database>> DataDirectory::OpenDatabase(const std::string& path) {
  if (auto made = MakeDirectories(path); !made) return made.error();
  auto opened = Database::Open(path + "/facetless.db");
  if (!opened) return opened;
  if (auto made = MakeSchema(*opened.value(), path); !made) return made.error();
  return opened;
}

DataDirectory::~DataDirectory() {
  // Close the database before the lock is released, so that the next process finds its log closed.
  reader_.reset();
  writer_.reset();
  close(lock_);
}

double WallClock() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace facetless
