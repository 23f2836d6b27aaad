// A data directory and its database, owned by one process at a time.
//
//   DIR/lock     DIR/facetless.db (with -wal and -shm beside it)     DIR/files/<first two digits>/<sha256>
//    DIR/tmp/
//
//  1. Open takes the lock. A second process is refused at once.
//  2. The database records which files belong to which items (data_directory.cpp describes the tables). A
//     file is on the disk before a row refers to it, and its rows are deleted before the file. A crash may
//     therefore leave files without rows, but never rows without files.
//  3. A database of a newer version is refused and not changed.
#pragma once

#include <memory>
#include <string>

#include "render/base/result.h"
#include "server/service/store/database.h"

namespace facetless {

// The version of the tables. It is increased when they change, and Open upgrades older databases.
inline constexpr int kSchemaVersion = 1;

class DataDirectory {
 public:
  // Opens the directory, and creates it if it is absent. Errors: kWriteFailed; kBadUsage (another process
  // uses it, or it is newer than this program); kFormatBroken.
  static Result<std::unique_ptr<DataDirectory>> Open(const std::string& path);
  ~DataDirectory();
  // Opens only the database, even while another process uses the directory, for access that does not concern
  // files or jobs.
  static Result<std::unique_ptr<Database>> OpenDatabase(const std::string& path);
  DataDirectory(const DataDirectory&) = delete;
  DataDirectory& operator=(const DataDirectory&) = delete;

  const std::string& path() const { return path_; }
  std::string FilePath(const std::string& sha256) const {
    return path_ + "/files/" + sha256.substr(0, 2) + "/" + sha256;
  }
  std::string TemporaryPath() const { return path_ + "/tmp"; }

  Database& writer() { return *writer_; }
  // For queries only, which do not wait for a commit.
  Database& reader() { return *reader_; }

 private:
  DataDirectory(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}

  const std::string path_;
  const int lock_;  // a file descriptor
  std::unique_ptr<Database> writer_, reader_;
};

// Seconds since 1970, UTC. All times in the database use this clock.
double WallClock();

}  // namespace facetless
