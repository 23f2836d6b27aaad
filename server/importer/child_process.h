// Runs a child process under limits, and watches it from its start to its end.
//
//     ChildRequest request{.program = "/usr/bin/true", .working_directory = "/tmp"};
//     request.limits.wall_seconds = 10;
//     Result<ChildOutcome> outcome = RunChild(request);
//
//  1. The child leads its own process group and has its own working directory, exactly the given environment,
//     an empty standard input, and no other open file of the parent. It dies if the parent dies. If
//     file_access is not empty, the child cannot reach any other file (file_access.h) and has no privileges,
//     even if the parent has some; it may still read what the parent may read.
//  2. RunChild returns when the child has ended and no process of its group remains. The child ends by
//     itself; or the parent kills it and its group with SIGKILL because of the wall clock, the cancel flag or
//     a watched limit; or one of its resource limits ends it. Watched limits are checked every 20 ms, and
//     those of the directory once more at the end.
//  3. The first stdout_cap bytes of standard output and the last stderr_cap bytes of standard error are kept.
//     The rest is read and discarded, so that a child with excessive output neither blocks nor fills the
//     memory of the parent.
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
#include "sandbox/confinement.h"

namespace facetless {

class ForkServer;

struct ChildRequest {
  std::string program;                   // path; PATH is not searched
  std::vector<std::string> arguments;    // without the program's name
  std::vector<std::string> environment;  // NAME=value
  std::string working_directory;
  ChildLimits limits;
  std::vector<sock_filter>
      syscall_filter;      // empty: no filter; kOwnProcess is replaced by the child's id (confinement.h)
  FileAccess file_access;  // empty: the same files as the parent
  std::size_t stdout_cap = 1 << 20;
  std::size_t stderr_cap = 1 << 16;
  std::function<void(std::string_view)>
      on_stderr_line;  // called for each complete line, without the line end; may be empty
  const std::atomic<bool>* cancel = nullptr;  // true kills the child
  std::function<bool()>
      expired;  // true kills the child like the wall clock; called at every check; may be empty
  ForkServer* fork_server = nullptr;  // of this program: it starts the child if it can (fork_server.h)
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
  bool forked = false;  // by the fork server
  std::uint64_t peak_bytes =
      0;  // largest sampled resident size; 0 if the child ended before the first sample
  std::uint64_t peak_address_bytes = 0;  // largest sampled address space
};

// Runs the child. Error: kInternal (the program cannot be started; the message has the reason given by the
// system).
Result<ChildOutcome> RunChild(const ChildRequest& request);

// The name of a signal, such as "SIGSEGV (segmentation fault)".
std::string SignalName(int signal);

}  // namespace facetless
