// How much a directory holds, while a process that we don't trust is still writing to it.
//
//  1. Counted is everything below it: names, and of each file the larger of its length and the space that it
//     takes. Symbolic links are counted and never followed.
//  2. Counting ends as soon as one of the limits is passed, so that a flood can't keep us busy; what
//     disappears meanwhile is not counted.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace facetless {

struct DirectoryUse {
  std::uint64_t bytes = 0, names = 0;
};

// Limits of 0: none.
DirectoryUse MeasureDirectory(const std::string& path, const DirectoryUse& limits);

// Bytes of regular files that the process holds open although no directory names them any more.
std::uint64_t NamelessBytes(pid_t process);

}  // namespace facetless
