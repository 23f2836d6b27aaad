// A temporary directory that exists as long as its object.
//
//     Result<TempDir> directory = TempDir::Create();
//     if (!directory) return directory.error();
//     const std::string path = directory.value().File("model.flm");
//
//  1. Create makes a new, empty directory with mode 0700. It is below `parent`, or below $TMPDIR or /tmp if
//     `parent` is empty.
//  2. The destructor removes the directory with its contents. It does not follow symbolic links, and never
//     throws.
#pragma once

#include <string>

#include "render/base/result.h"

namespace facetless {

class TempDir {
 public:
  // Creates the directory. Error: kWriteFailed.
  static Result<TempDir> Create(const std::string& parent = "");

  TempDir() = default;
  ~TempDir();
  TempDir(TempDir&& other) noexcept;
  TempDir& operator=(TempDir&& other) noexcept;

  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

}  // namespace facetless
