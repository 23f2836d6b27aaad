// The system-call filter of the importer process. It denies calls that a program that reads one file and
// writes two never needs.
//
//  1. These are denied with EPERM: sockets of any family; starting processes (threads are allowed); signals
//     to other processes; leaving the process group; tracing or reading other processes; changing priorities;
//     links, pipes and devices in the file system; memory files and message queues that outlive or escape the
//     limits; mounts; namespaces; kernel keys; BPF; performance counters; kernel modules; reboot.
//  2. Everything else is allowed, because OpenCASCADE, TBB and libc use an open-ended set of harmless calls.
//  3. The filter is made before the process. It contains the placeholder kOwnProcess for the process id,
//     which ConfineChild replaces (sandbox/confinement.h).
#pragma once

#include <linux/filter.h>

#include <vector>

#include "render/base/result.h"

namespace facetless {

// The filter program for prctl(PR_SET_SECCOMP). It must be made before fork, because libseccomp allocates.
// Error: kInternal.
Result<std::vector<sock_filter>> ImporterSyscallFilter();

}  // namespace facetless
