#include "sandbox/file_access.h"

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace facetless {
namespace {

// The constants of the kernel interface. They are defined here because headers are often older than the
// running kernel.
constexpr std::uint64_t kExecute = 1 << 0, kWriteFile = 1 << 1, kReadFile = 1 << 2, kReadDirectory = 1 << 3,
                        kRemoveDirectory = 1 << 4, kRemoveFile = 1 << 5, kMakeDirectory = 1 << 7,
                        kMakeRegular = 1 << 8, kTruncate = 1 << 14;
// The rights that a rule for a single file may contain.
constexpr std::uint64_t kOfFiles = kExecute | kWriteFile | kReadFile | kTruncate;

// All rights that a version of the interface knows. The kernel does not restrict rights that a ruleset does
// not list.
constexpr std::uint64_t KnownRights(int version) {
  if (version >= 5) return (1 << 16) - 1;
  if (version >= 3) return (1 << 15) - 1;
  return version == 2 ? (1 << 14) - 1 : (1 << 13) - 1;
}

// The attributes of a ruleset in version 6. An older kernel reads only the beginning.
struct RulesetAttributes {
  std::uint64_t files = 0, network = 0, scopes = 0;
};
constexpr std::uint64_t kAllNetwork = 3;  // bind and connect
constexpr std::uint64_t kAllScopes = 3;   // abstract sockets and signals

void Allow(int ruleset, const std::vector<std::string>& paths, std::uint64_t rights, std::uint64_t known) {
  for (const std::string& path : paths) {
    const int at = open(path.c_str(), O_PATH | O_CLOEXEC);
    if (at < 0) continue;
    struct stat info = {};
    if (fstat(at, &info) == 0) {
      landlock_path_beneath_attr rule = {};
      rule.allowed_access = rights & known & (S_ISDIR(info.st_mode) ? ~std::uint64_t{0} : kOfFiles);
      rule.parent_fd = at;
      syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    }
    close(at);
  }
}

}  // namespace

int LandlockVersion() {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  return version > 0 ? static_cast<int>(version) : 0;
}

bool ConfineFileAccess(const FileAccess& access) {
  const int before = errno;
  const int version = LandlockVersion();
  if (version == 0) {
    errno = before;
    return true;
  }
  // Restrict everything that this kernel can restrict.
  RulesetAttributes attributes;
  attributes.files = KnownRights(version);
  std::size_t size = sizeof attributes.files;
  if (version >= 4) {
    attributes.network = kAllNetwork;
    size += sizeof attributes.network;
  }
  if (version >= 6) {
    attributes.scopes = kAllScopes;
    size += sizeof attributes.scopes;
  }
  const long ruleset = syscall(SYS_landlock_create_ruleset, &attributes, size, 0);
  if (ruleset < 0) return false;

  // Allow the files that `access` names.
  const int rules = static_cast<int>(ruleset);
  constexpr std::uint64_t kRead = kReadFile | kReadDirectory;
  constexpr std::uint64_t kOpened = kRead | kWriteFile | kTruncate;
  Allow(rules, access.readable, kRead, attributes.files);
  Allow(rules, access.runnable, kRead | kExecute, attributes.files);
  Allow(rules, access.opened, kOpened, attributes.files);
  Allow(rules, access.writable, kOpened | kMakeRegular | kMakeDirectory | kRemoveFile | kRemoveDirectory,
        attributes.files);
  const bool confined = syscall(SYS_landlock_restrict_self, rules, 0) == 0;
  const int reason = errno;
  close(rules);
  errno = reason;
  return confined;
}

}  // namespace facetless
