// A directory that exists as long as the object does.
//
//  1. Create makes a new, empty directory that only this user may enter (0700), below `parent` or, if that is
//     empty, below $TMPDIR or /tmp.
//  2. The destructor removes it with everything in it. It never follows a symbolic link out of it, and never
//     throws.
#pragma once

#include <string>

#include "render/base/result.h"

namespace facetless {

class TempDir {
 public:
  // Error: kWriteFailed.
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
