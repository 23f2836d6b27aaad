// The system-call filter of the importer process. It denies calls that a program that reads one file and
// writes two never needs.
//
//  1. These are denied with EPERM: sockets of any family; starting processes (threads are allowed); signals
//     to other processes; leaving the process group; tracing or reading other processes; changing priorities;
//     links, pipes and devices in the file system; memory files and message queues that outlive or escape the
//     limits; mounts; namespaces; kernel keys; BPF; performance counters; kernel modules; reboot.
//  2. Everything else is allowed, because OpenCASCADE, TBB and libc use an open-ended set of harmless calls.
//  3. The filter is made before the process. It contains the placeholder kOwnProcess for the process id,
//     which SetOwnProcess replaces.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <vector>

#include "render/base/result.h"

namespace facetless {

// The filter program for prctl(PR_SET_SECCOMP). It must be made before fork, because libseccomp allocates.
// Error: kInternal.
Result<std::vector<sock_filter>> ImporterSyscallFilter();

// The placeholder for the id of the process itself. It is above the largest process id of Linux (2^22).
constexpr std::uint32_t kOwnProcess = 0x5e1f5e1f;

// Replaces kOwnProcess by `process`. It allocates nothing, so it may run between fork and exec.
void SetOwnProcess(std::vector<sock_filter>& filter, std::uint32_t process);

}  // namespace facetless
