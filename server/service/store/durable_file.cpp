#include "server/service/store/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace facetless {
namespace {

Error WriteError(const std::string& path, int reason) {
  return {ErrorCode::kWriteFailed, "cannot store " + path + ": " + std::strerror(reason)};
}

Result<void> Sync(const std::string& path, int flags) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  if (fd < 0) return WriteError(path, errno);
  const int reason = fsync(fd) == 0 ? 0 : errno;
  close(fd);
  if (reason != 0) return WriteError(path, reason);
  return {};
}

}  // namespace

Result<void> SyncFile(const std::string& path) {
  return Sync(path, 0);
}

Result<void> RenameReadOnly(const std::string& from, const std::string& to) {
  if (chmod(from.c_str(), 0444) != 0 || std::rename(from.c_str(), to.c_str()) != 0)
    return WriteError(to, errno);
  return {};
}

Result<void> SyncDirectory(const std::string& path) {
  return Sync(path, O_DIRECTORY);
}

}  // namespace facetless
