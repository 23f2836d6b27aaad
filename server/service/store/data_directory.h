// A data directory and its database, owned by one process at a time.
//
//   DIR/lock     DIR/facetless.db (with -wal and -shm beside it)     DIR/files/<first two digits>/<sha256>     DIR/tmp/
//
//  1. Open takes the lock; a second process is refused at once.
//  2. The database says which files belong to what (the tables are described in data_directory.cpp). A file
//     is on the disk before a row names it, and its rows are gone before it is removed: a crash leaves files
//     without rows, never rows without files.
//  3. A database of a newer version is refused and left as it is.
#pragma once

#include <memory>
#include <string>

#include "render/base/result.h"
#include "server/service/store/database.h"

namespace facetless {

// What the tables look like. A change of them raises it, and Open brings older ones up.
inline constexpr int kSchemaVersion = 1;

class DataDirectory {
 public:
  // Makes it if it is absent. Errors: kWriteFailed; kBadUsage (another process has it, or it is newer than
  // this program); kFormatBroken.
  static Result<std::unique_ptr<DataDirectory>> Open(const std::string& path);
  ~DataDirectory();
  // The database alone, also while another process has the directory: for what is not about files or jobs.
  static Result<std::unique_ptr<Database>> OpenDatabase(const std::string& path);
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& path() const { return path_; }
  std::string FilePath(const std::string& sha256) const {
    return path_ + "/files/" + sha256.substr(0, 2) + "/" + sha256;
  }
  std::string TemporaryPath() const { return path_ + "/tmp"; }

  Database& writer() { return *writer_; }
  // For questions only: they don't wait for a commit.
  Database& reader() { return *reader_; }

 private:
  DataDirectory(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}

  const std::string path_;
  const int lock_;  // a file descriptor
  std::unique_ptr<Database> writer_, reader_;
};

// Seconds since 1970, UTC: the clock of every row.
double WallClock();

}  // namespace facetless
