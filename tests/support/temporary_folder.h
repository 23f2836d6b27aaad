// A folder for the files of a test.
#pragma once

#include <string>

namespace facetless {

// A new, empty folder below $TMPDIR or /tmp, removed with all that is in it at the object's end. OpenCASCADE
// reads its settings from such a one, too.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string File(const std::string& name) const { return path_ + "/" + name; }
  // Writes `bytes` into a file of that name and returns its path.
  std::string Write(const std::string& name, const std::string& bytes) const;

 private:
  std::string path_;
};

}  // namespace facetless
