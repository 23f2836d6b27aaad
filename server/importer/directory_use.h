// The disk usage of a directory to which an untrusted process is still writing.
//
//  1. Everything below the directory is counted: names, and for each file the larger of its length and the
//     space that it occupies. Symbolic links are counted but never followed.
//  2. Counting ends as soon as one of the limits is exceeded, so that a large number of files cannot delay
//     the caller. Files that disappear during the count are not counted.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace facetless {

struct DirectoryUse {
  std::uint64_t bytes = 0, names = 0;
};

// Measures the usage. A limit of 0 means no limit.
DirectoryUse MeasureDirectory(const std::string& path, const DirectoryUse& limits);

// The size of the regular files that the process has open but that no directory contains any more, in bytes.
std::uint64_t UnlinkedFileBytes(pid_t process);

}  // namespace facetless
