#include "sandbox/confinement.h"

#include <fcntl.h>
#include <linux/bpf_common.h>
#include <linux/capability.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace facetless {
namespace {

// The number of tasks that other programs of this user may start while the child runs, such as other imports.
constexpr std::uint64_t kSpareTasks = 4096;

bool SetLimit(int resource, std::uint64_t value, std::uint64_t hard_extra = 0) {
  if (value == 0) return true;
  struct rlimit limit = {value, value + hard_extra};
  struct rlimit now = {};
  if (getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) return false;
  // Do not raise a limit that is already lower.
  limit.rlim_max = std::min(limit.rlim_max, now.rlim_max);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  return setrlimit(static_cast<__rlimit_resource>(resource), &limit) == 0;
}

bool SetLimits(const ChildLimits& limits, std::uint64_t tasks_before) {
  const struct rlimit no_core = {0, 0};
  return setrlimit(RLIMIT_CORE, &no_core) == 0 && SetLimit(RLIMIT_AS, limits.memory_bytes) &&
         // The soft limit sends SIGXCPU, which can be distinguished from the parent's SIGKILL. The hard limit is
         // for a child that ignores SIGXCPU.
         SetLimit(RLIMIT_CPU, limits.cpu_seconds, 2) && SetLimit(RLIMIT_FSIZE, limits.file_bytes) &&
         SetLimit(RLIMIT_NOFILE, limits.open_files) &&
         // This limit only supplements the watched limit, because it counts all processes of this user.
         (limits.threads == 0 || SetLimit(RLIMIT_NPROC, tasks_before + limits.threads + kSpareTasks));
}

void RestoreSignals() {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  struct sigaction standard = {};
  standard.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) sigaction(signal, &standard, nullptr);
}

bool SetStreams(const ChildStreams& streams) {
  const int report = fcntl(streams.report, F_DUPFD, 10);
  if (report < 0 || dup2(streams.in, 0) < 0 || dup2(streams.out, 1) < 0 || dup2(streams.error, 2) < 0 ||
      dup2(report, kReportDescriptor) < 0 || fcntl(kReportDescriptor, F_SETFD, FD_CLOEXEC) != 0)
    return false;
  if (close_range(kReportDescriptor + 1, ~0U, 0) != 0) {
    const long open_max = sysconf(_SC_OPEN_MAX);
    for (int fd = kReportDescriptor + 1; fd < open_max; ++fd) close(fd);
  }
  return true;
}

// Removes all capabilities of root except reading any file, because files to import may belong to other
// users: those that a program would get on exec, and those that the process has. For other users, there is
// nothing to remove, and the calls fail.
bool DropCapabilities() {
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  for (int capability = 0; capability < 64; ++capability) {
    if (capability != CAP_DAC_READ_SEARCH) prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
  }
  __user_cap_header_struct header = {_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3] = {};
  if (syscall(SYS_capget, &header, sets) != 0) return false;
  for (unsigned word = 0; word < _LINUX_CAPABILITY_U32S_3; ++word) {
    const std::uint32_t kept =
        word == CAP_TO_INDEX(CAP_DAC_READ_SEARCH) ? CAP_TO_MASK(CAP_DAC_READ_SEARCH) : 0;
    sets[word].effective &= kept;
    sets[word].permitted &= kept;
    sets[word].inheritable = 0;
  }
  return syscall(SYS_capset, &header, sets) == 0;
}

void SetOwnProcess(std::vector<sock_filter>& filter, std::uint32_t process) {
  for (sock_filter& step : filter) {
    if (BPF_CLASS(step.code) == BPF_JMP && step.k == kOwnProcess) step.k = process;
  }
}

}  // namespace

void EndUnconfined(int report) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(report, &reason, sizeof reason);
  _exit(127);
}

void ConfineChild(Confinement& confinement, const ChildStreams& streams) {
  // Die with the parent, even if it has just died.
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || setpgid(0, 0) != 0) EndUnconfined(streams.report);
  if (getppid() != confinement.parent) _exit(127);
  RestoreSignals();
  if (!SetStreams(streams)) EndUnconfined(streams.report);
  if (chdir(confinement.working_directory.c_str()) != 0 ||
      !SetLimits(confinement.limits, confinement.tasks_before))
    EndUnconfined(kReportDescriptor);

  // Give up privileges, restrict files, and finally install the system-call filter.
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) EndUnconfined(kReportDescriptor);
  if (!confinement.file_access.empty()) {
    if (!DropCapabilities() || !ConfineFileAccess(confinement.file_access)) EndUnconfined(kReportDescriptor);
  }
  if (!confinement.syscall_filter.empty()) {
    SetOwnProcess(confinement.syscall_filter, static_cast<std::uint32_t>(getpid()));
    const sock_fprog program = {static_cast<unsigned short>(confinement.syscall_filter.size()),
                                confinement.syscall_filter.data()};
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) EndUnconfined(kReportDescriptor);
  }
}

}  // namespace facetless
