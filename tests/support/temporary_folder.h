// A folder for the files of a test.
#pragma once

#include <string>

namespace facetless {

// Creates a new, empty folder below $TMPDIR or /tmp. The destructor removes it with its contents. It can also
// serve as the folder from which OpenCASCADE reads its settings.
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
