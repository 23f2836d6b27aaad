// The system-call filter of the importer process: what a program that reads one file and writes two never
// needs.
//
//  1. Denied with EPERM: sockets of any family, starting processes (threads are allowed), signals to any
//     process but itself, leaving its process group, tracing or reading other processes, other priorities,
//     links, pipes and devices in the file system, files and queues in memory that outlive or escape its
//     limits, mounts, namespaces, kernel keys, BPF, performance counters, modules, reboot.
//  2. Everything else is left alone: OpenCASCADE, TBB and libc use an open-ended set of harmless calls.
//  3. The filter is made before the process is: it holds kOwnProcess where the process's own number belongs,
//     and SetOwnProcess puts it in.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <vector>

#include "render/base/result.h"

namespace facetless {

// The program for prctl(PR_SET_SECCOMP). It is made before fork, since libseccomp allocates. Error:
// kInternal.
Result<std::vector<sock_filter>> ImporterSyscallFilter();

// Stands for the process's own number: above the largest that Linux gives to a process (2^22).
constexpr std::uint32_t kOwnProcess = 0x5e1f5e1f;

// Puts `process` where kOwnProcess stands. It allocates nothing, so it may run between fork and exec.
void SetOwnProcess(std::vector<sock_filter>& filter, std::uint32_t process);

}  // namespace facetless
