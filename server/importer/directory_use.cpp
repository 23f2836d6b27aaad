#include "server/importer/directory_use.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

namespace facetless {
namespace {

// The unit of st_blocks, whatever the block size of the file system is.
constexpr std::uint64_t kBlockBytes = 512;

std::uint64_t DiskBytes(const struct stat& info) {
  return std::max(static_cast<std::uint64_t>(info.st_size),
                  static_cast<std::uint64_t>(info.st_blocks) * kBlockBytes);
}

struct CloseDirectory {
  void operator()(DIR* directory) const { closedir(directory); }
};
using Directory = std::unique_ptr<DIR, CloseDirectory>;

bool IsSelfOrParent(std::string_view name) {
  return name == "." || name == "..";
}

}  // namespace

DirectoryUse MeasureDirectory(const std::string& path, const DirectoryUse& limits) {
  DirectoryUse use;
  const auto beyond = [&] {
    return (limits.bytes > 0 && use.bytes > limits.bytes) || (limits.names > 0 && use.names > limits.names);
  };
  std::vector<std::string> open = {path};
  while (!open.empty() && !beyond()) {
    const std::string at = std::move(open.back());
    open.pop_back();
    const Directory directory(opendir(at.c_str()));
    if (directory == nullptr) continue;
    while (const dirent* entry = readdir(directory.get())) {
      if (IsSelfOrParent(entry->d_name)) continue;
      ++use.names;
      struct stat info = {};
      if (fstatat(dirfd(directory.get()), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) != 0) continue;
      if (S_ISREG(info.st_mode)) use.bytes += DiskBytes(info);
      if (S_ISDIR(info.st_mode)) open.push_back(at + "/" + entry->d_name);
      if (beyond()) break;
    }
  }
  return use;
}

std::uint64_t UnlinkedFileBytes(pid_t process) {
  const std::string path = "/proc/" + std::to_string(process) + "/fd";
  const Directory directory(opendir(path.c_str()));
  std::uint64_t bytes = 0;
  while (const dirent* entry = directory == nullptr ? nullptr : readdir(directory.get())) {
    struct stat info = {};
    if (!IsSelfOrParent(entry->d_name) && fstatat(dirfd(directory.get()), entry->d_name, &info, 0) == 0 &&
        S_ISREG(info.st_mode) && info.st_nlink == 0)
      bytes += DiskBytes(info);
  }
  return bytes;
}

}  // namespace facetless
