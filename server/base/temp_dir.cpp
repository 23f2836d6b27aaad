#include "server/base/temp_dir.h"

#include <stdlib.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace facetless {
namespace {

// Moves every directory below `root` directly into it, so that a tree can be removed that is deeper than the
// limits of paths or open files. Each round works on only two levels.
void Flatten(const std::string& root) {
  std::error_code ignored;
  std::uint64_t moved = 0;
  for (bool deep = true; deep;) {
    deep = false;
    std::vector<std::filesystem::path> directories;
    for (const auto& entry : std::filesystem::directory_iterator(root, ignored))
      if (entry.symlink_status(ignored).type() == std::filesystem::file_type::directory)
        directories.push_back(entry.path());
    for (const std::filesystem::path& directory : directories) {
      for (const auto& entry : std::filesystem::directory_iterator(directory, ignored)) {
        if (entry.symlink_status(ignored).type() != std::filesystem::file_type::directory) continue;
        std::filesystem::rename(entry.path(), root + "/flattened" + std::to_string(moved++), ignored);
        deep = deep || !ignored;
      }
      std::filesystem::remove_all(directory, ignored);
    }
  }
}

}  // namespace

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
  if (!ignored) return;
  Flatten(path_);
  std::filesystem::remove_all(path_, ignored);
}

TempDir::TempDir(TempDir&& other) noexcept : path_(std::exchange(other.path_, {})) {}

TempDir& TempDir::operator=(TempDir&& other) noexcept {
  if (this != &other) std::swap(path_, other.path_);
  return *this;
}

}  // namespace facetless
