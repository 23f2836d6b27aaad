#include "server/temp_dir.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace facetless {

Result<TempDir> TempDir::Create(const std::string& parent) {
  std::string root = parent;
  if (root.empty()) {
    const char* tmp = std::getenv("TMPDIR");
    root = tmp != nullptr && *tmp != '\0' ? tmp : "/tmp";
  }
  std::string name = root + "/facetless-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) {
    return Error{ErrorCode::kWriteFailed,
                 "cannot make a temporary directory in " + root + ": " + std::strerror(errno)};
  }
  TempDir dir;
  dir.path_ = std::move(name);
  return dir;
}

TempDir::~TempDir() {
  if (path_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

TempDir::TempDir(TempDir&& other) noexcept : path_(std::exchange(other.path_, {})) {}

TempDir& TempDir::operator=(TempDir&& other) noexcept {
  if (this != &other) std::swap(path_, other.path_);
  return *this;
}

}  // namespace facetless
