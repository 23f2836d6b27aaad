// A child process under limits, watched from its start to its end.
//
//  1. The child leads its own process group, in its own working directory, with exactly the environment
//     given, nothing on standard input, and no other open file of ours. It dies if we die.
//     Where file_access names anything, it reaches no other file (file_access.h) and has no privileges, also
//     if we have some; but it may read what we may read.
//  2. RunChild returns when the child has ended and nothing of its group is left: at its own exit, when the
//     wall clock, the cancel flag or one of the limits that are watched from outside ended it (SIGKILL to it
//     and its group), or when one of its resource limits did. Watched limits are looked at every 20 ms, and
//     those of its directory once more at its end.
//  3. Standard output is kept up to stdout_cap bytes, of standard error the last stderr_cap bytes; what goes
//     beyond is read and dropped, so that a child that floods neither blocks nor fills our memory.
#pragma once

#include <linux/filter.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/result.h"
#include "server/importer/file_access.h"

namespace facetless {

struct ChildLimits {               // 0: no limit
  std::uint64_t memory_bytes = 0;  // address space (RLIMIT_AS)
  std::uint64_t cpu_seconds = 0;   // of all threads together
  double wall_seconds = 0;         // ChildRequest::expired is a clock with rules of its own
  std::uint64_t file_bytes = 0;    // of each file that it writes
  std::uint64_t open_files = 0;
  std::uint64_t threads = 0;          // watched: also root's threads count, unlike with RLIMIT_NPROC
  std::uint64_t directory_bytes = 0;  // watched: of all files below the working directory, and of files that
                                      // it has removed and keeps open
  std::uint64_t directory_names = 0;  // watched: files and directories there
};

struct ChildRequest {
  std::string program;                   // path; PATH is not searched
  std::vector<std::string> arguments;    // without the program's name
  std::vector<std::string> environment;  // NAME=value
  std::string working_directory;
  ChildLimits limits;
  std::vector<sock_filter> syscall_filter;  // empty: none; kOwnProcess becomes the child's number (sandbox.h)
  FileAccess file_access;                   // empty: everything that we may
  std::size_t stdout_cap = 1 << 20;
  std::size_t stderr_cap = 1 << 16;
  std::function<void(std::string_view)>
      on_stderr_line;                         // called for each whole line, without its end; may be empty
  const std::atomic<bool>* cancel = nullptr;  // true kills the child
  std::function<bool()> expired;  // true ends it as the wall clock does; asked at every look; may be empty
};

enum class ChildEnd : std::uint8_t {
  kExited,
  kSignalled,
  kTimedOut,
  kCancelled,
  kTooManyThreads,
  kDirectoryTooLarge,  // directory_bytes
  kTooManyNames        // directory_names
};

struct ChildOutcome {
  ChildEnd end = ChildEnd::kExited;
  int exit_code = 0;            // kExited
  int signal = 0;               // kSignalled
  std::string out, error_tail;  // standard output and the end of standard error
  double wall_ms = 0;
  std::uint64_t peak_bytes = 0;  // largest resident size, sampled; 0 if it ended before the first sample
  std::uint64_t peak_address_bytes = 0;  // largest address space, the same way
};

// Error: kInternal if the program cannot be started, with the system's reason.
Result<ChildOutcome> RunChild(const ChildRequest& request);

// "SIGSEGV (segmentation fault)".
std::string SignalName(int signal);

}  // namespace facetless
