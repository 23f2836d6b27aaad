#include "server/importer/syscall_filter.h"

#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "sandbox/confinement.h"

namespace facetless {
namespace {

// The denied calls, by name, so that calls that are unknown to the kernel headers do not break the build.
constexpr const char* kDenied[] = {
    "socket", "socketpair", "connect", "bind", "listen", "accept", "accept4", "sendto", "sendmsg", "sendmmsg",
    "fork", "vfork", "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "process_mrelease",
    "move_pages", "migrate_pages", "kcmp", "pidfd_getfd", "mount", "umount2", "pivot_root", "chroot",
    "unshare", "setns", "open_by_handle_at", "bpf", "perf_event_open", "userfaultfd", "io_uring_setup",
    "keyctl", "add_key", "request_key", "init_module", "finit_module", "delete_module", "kexec_load",
    "kexec_file_load", "reboot", "swapon", "swapoff", "acct", "settimeofday", "clock_settime", "adjtimex",
    "personality",
    // Calls that leave the process group, which is killed as a whole.
    "setpgid", "setsid",
    // Signals. kill and tgkill have separate rules below.
    "tkill", "rt_sigqueueinfo", "rt_tgsigqueueinfo", "pidfd_send_signal",
    // A real-time thread, which root may start, would block the parent process.
    "sched_setscheduler", "sched_setparam", "sched_setattr", "setpriority", "ioprio_set",
    // The output must be regular files of their own.
    "symlink", "symlinkat", "link", "linkat", "mknod", "mknodat",
    // Memory that no limit counts, or that persists after the process.
    "memfd_create", "memfd_secret", "shmget", "msgget", "semget", "mq_open"};

}  // namespace

Result<std::vector<sock_filter>> ImporterSyscallFilter() {
  const auto failed = [](const char* step) {
    return Error{ErrorCode::kInternal,
                 std::string("cannot build the importer's system-call filter: ") + step};
  };
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> context(seccomp_init(SCMP_ACT_ALLOW),
                                                                 seccomp_release);
  if (context == nullptr) return failed("init");
  // Deny the calls by name. A call that does not exist on this architecture cannot be made anyway.
  for (const char* name : kDenied) {
    const int number = seccomp_syscall_resolve_name(name);
    if (number == __NR_SCMP_ERROR) continue;
    const int result = seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EPERM), number, 0);
    if (result != 0 && result != -EDOM) return failed(name);
  }
  // Allow threads, but no processes: clone must have CLONE_THREAD. A filter cannot see the flags of clone3,
  // so clone3 is reported as not existing, and the C library falls back to clone.
  if (seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EPERM), SCMP_SYS(clone), 1,
                       SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0)) != 0)
    return failed("clone");
  if (seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0) != 0)
    return failed("clone3");

  // Allow signals only to the process itself, as for a failed assertion.
  for (const int call : {SCMP_SYS(kill), SCMP_SYS(tgkill)}) {
    if (seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EPERM), call, 1, SCMP_A0(SCMP_CMP_NE, kOwnProcess)) !=
        0)
      return failed("kill");
  }
  // The process must not reset the signal that it receives when its parent dies.
  if (seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prctl), 1,
                       SCMP_A0(SCMP_CMP_EQ, PR_SET_PDEATHSIG)) != 0)
    return failed("prctl");
  // Allow changes of limits and processors only for the process itself, for which the C library uses 0.
  for (const int call : {SCMP_SYS(prlimit64), SCMP_SYS(sched_setaffinity)}) {
    if (seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EPERM), call, 1, SCMP_A0(SCMP_CMP_NE, 0)) != 0)
      return failed("prlimit64");
  }
  // Deny files without a name, because they would not be counted in the directory.
  for (const auto& [call, argument] : {std::pair{SCMP_SYS(open), 1U}, std::pair{SCMP_SYS(openat), 2U}}) {
    const int result = seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(EOPNOTSUPP), call, 1,
                                        SCMP_CMP(argument, SCMP_CMP_MASKED_EQ, O_TMPFILE, O_TMPFILE));
    if (result != 0 && result != -EDOM) return failed("open");
  }
  // A filter cannot see the flags of openat2, so openat2 is reported as not existing.
  if (const int call = seccomp_syscall_resolve_name("openat2");
      call != __NR_SCMP_ERROR && seccomp_rule_add(context.get(), SCMP_ACT_ERRNO(ENOSYS), call, 0) != 0)
    return failed("openat2");

  // Export the filter program through a memory file.
  const int file = memfd_create("facetless-filter", MFD_CLOEXEC);
  if (file < 0) return failed("memfd_create");
  const bool exported = seccomp_export_bpf(context.get(), file) == 0;
  const off_t bytes = exported ? lseek(file, 0, SEEK_END) : -1;
  std::vector<sock_filter> program(bytes > 0 ? static_cast<std::size_t>(bytes) / sizeof(sock_filter) : 0);
  const ssize_t wanted = static_cast<ssize_t>(program.size() * sizeof(sock_filter));
  const bool read_back =
      wanted > 0 && pread(file, program.data(), static_cast<std::size_t>(wanted), 0) == wanted;
  close(file);
  if (!read_back) return failed("export");
  return program;
}

}  // namespace facetless
