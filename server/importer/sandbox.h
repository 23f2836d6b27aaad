// The system-call filter of the importer process: what a program that reads one file and writes two never
// needs.
//
//  1. Denied with EPERM: sockets of any family, starting processes (threads are allowed), tracing or reading
//     other processes, mounts, namespaces, kernel keys, BPF, performance counters, modules, reboot.
//  2. Everything else is left alone: OpenCASCADE, TBB and libc use an open-ended set of harmless calls.
#pragma once

#include <linux/filter.h>

#include <vector>

#include "render/model/result.h"

namespace facetless {

// The program for prctl(PR_SET_SECCOMP). It is made before fork, since libseccomp allocates. Error:
// kInternal.
Result<std::vector<sock_filter>> ImporterSyscallFilter();

}  // namespace facetless
