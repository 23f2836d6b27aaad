#include "server/base/files.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace facetless {
namespace {

Error WriteError(const std::string& path, int reason) {
  return {ErrorCode::kWriteFailed, "cannot write " + path + ": " + std::strerror(reason)};
}

// The permissions of a new file. The 0600 of mkstemp would make reports unreadable for other users.
mode_t NewFileMode() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

}  // namespace

Result<void> WriteFileAtomically(const std::string& path, std::string_view bytes) {
  static const mode_t mode = NewFileMode();
  std::string temporary = path + ".XXXXXX";
  const int fd = mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) return WriteError(path, errno);
  int reason = fchmod(fd, mode) == 0 ? 0 : errno;
  while (reason == 0 && !bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      reason = errno;
    }
  }
  if (close(fd) != 0 && reason == 0) reason = errno;
  if (reason == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return {};
  unlink(temporary.c_str());
  return WriteError(path, reason);
}

Result<void> MoveFile(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) == 0) return {};
  if (errno != EXDEV) return WriteError(to, errno);
  // On another file system, copy to a temporary file next to the destination and rename it.
  const std::string temporary = to + ".part";
  std::error_code error;
  std::filesystem::copy_file(from, temporary, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) std::filesystem::rename(temporary, to, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return WriteError(to, error.value());
  }
  std::filesystem::remove(from, error);
  return {};
}

Result<std::string> ReadFile(const std::string& path, std::size_t max_bytes) {
  std::ifstream file(path, std::ios::binary);
  std::error_code error;
  if (!file || !std::filesystem::is_regular_file(path, error))
    return Error{ErrorCode::kFileUnreadable, "cannot open " + path};
  std::string bytes;
  char buffer[1 << 16];
  while (file) {
    file.read(buffer, sizeof buffer);
    bytes.append(buffer, static_cast<std::size_t>(file.gcount()));
    if (bytes.size() > max_bytes)
      return Error{ErrorCode::kLimitExceeded,
                   path + " is larger than " + std::to_string(max_bytes) + " bytes"};
  }
  if (file.bad()) return Error{ErrorCode::kFileUnreadable, "cannot read " + path};
  return bytes;
}

Result<void> MakeDirectories(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error)
    return Error{ErrorCode::kWriteFailed, "cannot make the directory " + path + ": " + error.message()};
  return {};
}

std::string JsonText(const nlohmann::json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace facetless
