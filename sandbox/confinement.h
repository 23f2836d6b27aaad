// What a child process may reach and use up, and the change of a process into such a child.
//
//  1. ConfineChild changes the calling process, between fork and the child's own work. It makes only
//     async-signal-safe calls, because another thread of the parent may have held any lock at the fork.
//  2. After it, the process leads its own process group and dies with its parent. Signals have their default
//     effects. Its streams are those given, and no other file is open. It is in its directory, and under its
//     limits. If file_access is not empty, it can reach no other file (file_access.h), and it has no
//     privileges except reading the files of other users. The system-call filter is installed last.
#pragma once

#include <linux/filter.h>
#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "sandbox/file_access.h"

namespace facetless {

struct ChildLimits {               // 0: no limit
  std::uint64_t memory_bytes = 0;  // address space (RLIMIT_AS)
  std::uint64_t cpu_seconds = 0;   // CPU time of all threads together
  double wall_seconds = 0;         // watched by the parent
  std::uint64_t file_bytes = 0;    // size of each file that the child writes
  std::uint64_t open_files = 0;
  std::uint64_t threads = 0;  // watched by the parent; unlike RLIMIT_NPROC, it also applies to root
  // Watched by the parent: the size of all files below the working directory, with removed files that the child
  // keeps open, and the number of files and directories there.
  std::uint64_t directory_bytes = 0;
  std::uint64_t directory_names = 0;
};

struct Confinement {
  std::string working_directory;
  ChildLimits limits;
  std::vector<sock_filter> syscall_filter;  // empty: no filter
  FileAccess file_access;                   // empty: the same files as the parent
  std::uint64_t tasks_before = 0;           // processes and threads of the machine at the start
  pid_t parent = 0;                         // the process that the child dies with
};

// Descriptors. Standard input, output and error are the first three. `report` becomes kReportDescriptor, which
// closes on exec: a child that cannot be confined writes errno to it.
constexpr int kReportDescriptor = 3;
struct ChildStreams {
  int in = -1, out = -1, error = -1, report = -1;
};

// The placeholder for the id of the child itself in a system-call filter, which is made before the child is. It is
// above the largest process id of Linux (2^22).
constexpr std::uint32_t kOwnProcess = 0x5e1f5e1f;

// Confines the calling process. It writes its id into the filter of `confinement`. If a step fails, or if the
// parent is dead, it ends the process.
void ConfineChild(Confinement& confinement, const ChildStreams& streams);

// Writes errno to `report` and ends the process.
[[noreturn]] void EndUnconfined(int report);

}  // namespace facetless
