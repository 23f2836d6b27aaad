#include "render/image/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace facetless {
namespace {

Error Failed(const std::string& path, int number) {
  return {ErrorCode::kWriteFailed, path + ": cannot be written: " + std::strerror(number)};
}

// Writes all bytes. Returns 0, or errno if it fails.
int WriteAll(int file, std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

Result<void> WriteAtomically(const std::string& path, std::span<const unsigned char> bytes) {
  // Choose a name that no other thread or process uses.
  static std::atomic<std::uint64_t> counter{0};
  const std::string temporary =
      path + ".partial-" + std::to_string(::getpid()) + "-" + std::to_string(counter.fetch_add(1));
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) return Failed(path, errno);

  int problem = WriteAll(file, bytes);
  if (::close(file) != 0 && problem == 0) problem = errno;
  if (problem == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) problem = errno;
  if (problem != 0) {
    ::unlink(temporary.c_str());
    return Failed(path, problem);
  }
  return {};
}

}  // namespace facetless
