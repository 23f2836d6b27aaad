#include "server/importer/child_process.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <utility>

#include "render/base/stopwatch.h"
#include "server/importer/directory_use.h"
#include "server/importer/sandbox.h"

namespace facetless {
namespace {

// The interval at which the cancel flag, the wall clock and the watched limits are checked.
constexpr int kPollMs = 20;
// The number of tasks that other programs of this user may start while the child runs, such as other imports.
constexpr std::uint64_t kSpareTasks = 4096;

class Fd {
 public:
  explicit Fd(int fd = -1) : fd_(fd) {}
  ~Fd() { Close(); }
  Fd(Fd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Fd& operator=(Fd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  int get() const { return fd_; }
  void Close() {
    if (fd_ >= 0) close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
};

struct Pipe {
  Fd read, write;
  bool Open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return false;
    read = Fd(ends[0]);
    write = Fd(ends[1]);
    return true;
  }
};

std::vector<char*> Pointers(const std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (const std::string& s : strings) pointers.push_back(const_cast<char*>(s.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

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

// The data that the child needs between fork and exec. It is prepared before the fork, because after it only
// async-signal-safe calls are allowed: another thread may have held any lock.
struct ChildPlan {
  std::vector<std::string> argument_strings;
  std::vector<char*> arguments, environment;
  const ChildRequest* request = nullptr;
  std::vector<sock_filter> filter;
  std::uint64_t tasks_before = 0;
  int null_fd = -1, out_fd = -1, err_fd = -1, report_fd = -1;
  pid_t parent = 0;
};

[[noreturn]] void FailInChild(int report_fd) {
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(report_fd, &reason, sizeof reason);
  _exit(127);
}

// Removes all capabilities of root except reading any file, because files to import may belong to other
// users. For other users, there is nothing to remove, and the calls fail.
void DropCapabilities() {
  prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  for (int capability = 0; capability < 64; ++capability) {
    if (capability != CAP_DAC_READ_SEARCH) prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
  }
}

[[noreturn]] void BecomeChild(ChildPlan& plan) {
  // Die with the parent, even if it has just died.
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || setpgid(0, 0) != 0) FailInChild(plan.report_fd);
  if (getppid() != plan.parent) _exit(127);

  // Restore default signal handling, and unblock all signals.
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  struct sigaction standard = {};
  standard.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) sigaction(signal, &standard, nullptr);

  // Set up the standard streams. The pipe that reports a failed start becomes descriptor 3 and closes on
  // exec. All other descriptors are closed.
  const int report = fcntl(plan.report_fd, F_DUPFD, 10);
  if (report < 0 || dup2(plan.null_fd, 0) < 0 || dup2(plan.out_fd, 1) < 0 || dup2(plan.err_fd, 2) < 0 ||
      dup2(report, 3) < 0 || fcntl(3, F_SETFD, FD_CLOEXEC) != 0)
    FailInChild(plan.report_fd);
  if (close_range(4, ~0U, 0) != 0) {
    const long open_max = sysconf(_SC_OPEN_MAX);
    for (int fd = 4; fd < open_max; ++fd) close(fd);
  }

  // Set the working directory and the limits.
  const ChildLimits& limits = plan.request->limits;
  if (chdir(plan.request->working_directory.c_str()) != 0) FailInChild(3);
  const struct rlimit no_core = {0, 0};
  if (setrlimit(RLIMIT_CORE, &no_core) != 0 || !SetLimit(RLIMIT_AS, limits.memory_bytes) ||
      // The soft limit sends SIGXCPU, which can be distinguished from the parent's SIGKILL. The hard limit is
      // for a child that ignores SIGXCPU.
      !SetLimit(RLIMIT_CPU, limits.cpu_seconds, 2) || !SetLimit(RLIMIT_FSIZE, limits.file_bytes) ||
      !SetLimit(RLIMIT_NOFILE, limits.open_files) ||
      // This limit only supplements the watched limit, because it counts all processes of this user.
      (limits.threads > 0 && !SetLimit(RLIMIT_NPROC, plan.tasks_before + limits.threads + kSpareTasks)))
    FailInChild(3);

  // Give up privileges, restrict files, and finally install the system-call filter.
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) FailInChild(3);
  if (!plan.request->file_access.empty()) {
    DropCapabilities();
    if (!ConfineFileAccess(plan.request->file_access)) FailInChild(3);
  }
  if (!plan.filter.empty()) {
    SetOwnProcess(plan.filter, static_cast<std::uint32_t>(getpid()));
    const sock_fprog program = {static_cast<unsigned short>(plan.filter.size()), plan.filter.data()};
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) FailInChild(3);
  }
  execve(plan.request->program.c_str(), plan.arguments.data(), plan.environment.data());
  FailInChild(3);
}

// Reads the available data. Returns false at the end of the stream.
bool Drain(int fd, const std::function<void(std::string_view)>& take) {
  char buffer[1 << 14];
  for (;;) {
    const ssize_t got = read(fd, buffer, sizeof buffer);
    if (got > 0) {
      take({buffer, static_cast<std::size_t>(got)});
      // Return after a full buffer, so that a large amount of output does not delay the checks of the clock.
      return true;
    }
    if (got < 0 && errno == EINTR) continue;
    return got < 0 && errno == EAGAIN;
  }
}

// The number of processes and threads of the machine, from the fourth field of /proc/loadavg ("running/all");
// 0 if it cannot be read.
std::uint64_t TasksOfMachine() {
  std::ifstream file("/proc/loadavg");
  std::string word;
  for (int i = 0; i < 4; ++i) file >> word;
  const std::size_t slash = word.find('/');
  return slash == std::string::npos ? 0 : std::strtoull(word.c_str() + slash + 1, nullptr, 10);
}

// The largest resident size and address space so far, and the current number of threads, from /proc. Unlike
// the values of getrusage, these start at exec and do not include the size of the parent at the fork.
struct StatusSamples {
  std::uint64_t resident = 0, address_space = 0, threads = 0;
  void Sample(pid_t child) {
    std::ifstream status("/proc/" + std::to_string(child) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("Threads:")) threads = std::strtoull(line.c_str() + 8, nullptr, 10);
      const bool is_resident = line.starts_with("VmHWM:");
      if (!is_resident && !line.starts_with("VmPeak:")) continue;
      const std::uint64_t bytes = std::strtoull(line.c_str() + line.find(':') + 1, nullptr, 10) * 1024;
      std::uint64_t& peak = is_resident ? resident : address_space;
      peak = std::max(peak, bytes);
    }
  }
};

// The limit of its directory that the child has exceeded, if any. `child` is 0 if it has ended.
std::optional<ChildEnd> DirectoryEnd(const ChildRequest& request, pid_t child) {
  const DirectoryUse limit{request.limits.directory_bytes, request.limits.directory_names};
  if (limit.bytes == 0 && limit.names == 0) return std::nullopt;
  DirectoryUse use = MeasureDirectory(request.working_directory, limit);
  if (child > 0) use.bytes += UnlinkedFileBytes(child);
  if (limit.bytes > 0 && use.bytes > limit.bytes) return ChildEnd::kDirectoryTooLarge;
  if (limit.names > 0 && use.names > limit.names) return ChildEnd::kTooManyNames;
  return std::nullopt;
}

// Processes standard error: keeps its tail, and calls back for each line.
class ErrorStream {
 public:
  explicit ErrorStream(const ChildRequest& request) : request_(request) {}
  void Append(std::string_view bytes) {
    tail_ += bytes;
    if (tail_.size() > 2 * request_.stderr_cap) tail_.erase(0, tail_.size() - request_.stderr_cap);
    if (!request_.on_stderr_line) return;
    for (const char c : bytes) {
      if (c != '\n') {
        // Cut lines that are longer than any valid one.
        if (line_.size() < 4096) line_ += c;
        continue;
      }
      request_.on_stderr_line(line_);
      line_.clear();
    }
  }
  std::string Tail() && {
    if (tail_.size() > request_.stderr_cap) tail_.erase(0, tail_.size() - request_.stderr_cap);
    return std::move(tail_);
  }

 private:
  const ChildRequest& request_;
  std::string tail_, line_;
};

Error CannotStart(const ChildRequest& request, int reason) {
  return {ErrorCode::kInternal, "cannot start " + request.program + ": " + strerror(reason)};
}

// The pipes between parent and child; `report` tells why exec failed and is closed when it succeeds.
struct ChildPipes {
  Pipe out, err, report;
  bool Open() {
    if (!out.Open() || !err.Open() || !report.Open()) return false;
    for (const Pipe* pipe : {&out, &err, &report}) fcntl(pipe->read.get(), F_SETFL, O_NONBLOCK);
    return true;
  }
  void CloseWriteEnds() {
    out.write.Close();
    err.write.Close();
    report.write.Close();
  }
};

ChildPlan PlanChild(const ChildRequest& request, const ChildPipes& pipes, const Fd& null) {
  ChildPlan plan;
  plan.request = &request;
  plan.argument_strings = {request.program};
  plan.argument_strings.insert(plan.argument_strings.end(), request.arguments.begin(),
                               request.arguments.end());
  plan.arguments = Pointers(plan.argument_strings);
  plan.environment = Pointers(request.environment);
  plan.filter = request.syscall_filter;
  if (request.limits.threads > 0) plan.tasks_before = TasksOfMachine();
  plan.null_fd = null.get();
  plan.out_fd = pipes.out.write.get();
  plan.err_fd = pipes.err.write.get();
  plan.report_fd = pipes.report.write.get();
  plan.parent = getpid();
  return plan;
}

// Starts the child. Returns its id, or -1 with errno set.
pid_t StartChild(ChildPlan& plan) {
  // Fork with every signal blocked, so that no handler of the parent runs in the child.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = fork();
  const int fork_error = errno;
  if (child == 0) BecomeChild(plan);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  // Both processes create the group, so that it exists whichever of them runs first. This call fails if the
  // child has already called exec, which does no harm.
  if (child > 0) setpgid(child, child);
  errno = fork_error;
  return child;
}

// Watches a child from its start to its end: its streams, the clock, the cancel flag and the limits.
class ChildWatch {
 public:
  ChildWatch(const ChildRequest& request, const ChildPipes& pipes, pid_t child, const Stopwatch& stopwatch)
      : request_(request),
        pipes_(pipes),
        child_(child),
        stopwatch_(stopwatch),
        // Use the system call directly, because this C library declares its wrapper without C linkage.
        process_(static_cast<int>(syscall(SYS_pidfd_open, child, 0))),
        error_stream_(request) {}

  // Returns when the child has ended. A child that exceeds a limit is killed.
  void WaitForEnd() {
    for (bool running = true; running;) {
      struct pollfd watched[3] = {{out_open_ ? pipes_.out.read.get() : -1, POLLIN, 0},
                                  {err_open_ ? pipes_.err.read.get() : -1, POLLIN, 0},
                                  {process_.get(), POLLIN, 0}};
      poll(watched, 3, kPollMs);
      if (watched[0].revents != 0) DrainOut();
      if (watched[1].revents != 0) DrainErr();
      // exec has succeeded when the report pipe is closed.
      if (!started_) started_ = ReadReport() == 0;
      if (started_) samples_.Sample(child_);
      siginfo_t info = {};
      running = waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
                info.si_pid == 0;
      if (!running || killed_) continue;
      const std::optional<ChildEnd> end = ReasonToKill();
      if (!end) continue;
      // Kill the group and the child itself, which may have left the group.
      outcome_.end = *end;
      kill(-child_, SIGKILL);
      kill(child_, SIGKILL);
      killed_ = true;
    }
    outcome_.wall_ms = stopwatch_.Milliseconds();
  }

  // Kills what the child has left behind, reads the remaining output and reaps the child, which has ended.
  Result<ChildOutcome> Reap() {
    // The unreaped child still reserves the id of the group.
    kill(-child_, SIGKILL);
    for (int i = 0; i < 64 && out_open_; ++i) DrainOut();
    for (int i = 0; i < 64 && err_open_; ++i) DrainErr();
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    outcome_.peak_bytes = samples_.resident;
    outcome_.peak_address_bytes = samples_.address_space;
    outcome_.error_tail = std::move(error_stream_).Tail();
    // Check the directory once more for what the child wrote last.
    if (const auto end = DirectoryEnd(request_, 0); end && !killed_) {
      outcome_.end = *end;
      killed_ = true;
    }

    // If exec failed, read the reason from the report pipe.
    if (start_error_ == 0 && !started_) ReadReport();
    if (start_error_ != 0) return CannotStart(request_, start_error_);
    if (killed_) return std::move(outcome_);
    if (WIFSIGNALED(status)) {
      outcome_.end = ChildEnd::kSignalled;
      outcome_.signal = WTERMSIG(status);
    } else {
      outcome_.exit_code = WEXITSTATUS(status);
    }
    return std::move(outcome_);
  }

 private:
  void DrainOut() {
    out_open_ = Drain(pipes_.out.read.get(), [this](std::string_view bytes) {
      outcome_.out += bytes.substr(0, request_.stdout_cap - outcome_.out.size());
    });
  }
  void DrainErr() {
    err_open_ = Drain(pipes_.err.read.get(), [this](std::string_view bytes) { error_stream_.Append(bytes); });
  }
  ssize_t ReadReport() { return read(pipes_.report.read.get(), &start_error_, sizeof start_error_); }

  std::optional<ChildEnd> ReasonToKill() const {
    const ChildLimits& limits = request_.limits;
    if (request_.cancel != nullptr && *request_.cancel) return ChildEnd::kCancelled;
    if (limits.wall_seconds > 0 && stopwatch_.Seconds() > limits.wall_seconds) return ChildEnd::kTimedOut;
    if (request_.expired && request_.expired()) return ChildEnd::kTimedOut;
    if (limits.threads > 0 && samples_.threads > limits.threads) return ChildEnd::kTooManyThreads;
    if (started_) return DirectoryEnd(request_, child_);
    return std::nullopt;
  }

  const ChildRequest& request_;
  const ChildPipes& pipes_;
  const pid_t child_;
  const Stopwatch& stopwatch_;
  const Fd process_;
  ErrorStream error_stream_;
  StatusSamples samples_;
  ChildOutcome outcome_;
  bool out_open_ = true, err_open_ = true, started_ = false, killed_ = false;
  int start_error_ = 0;  // errno of the child, if it could not call exec
};

}  // namespace

Result<ChildOutcome> RunChild(const ChildRequest& request) {
  ChildPipes pipes;
  const Fd null(open("/dev/null", O_RDONLY | O_CLOEXEC));
  if (!pipes.Open() || null.get() < 0) return CannotStart(request, errno);
  ChildPlan plan = PlanChild(request, pipes, null);
  const Stopwatch stopwatch;
  const pid_t child = StartChild(plan);
  if (child < 0) return CannotStart(request, errno);
  pipes.CloseWriteEnds();
  ChildWatch watch(request, pipes, child, stopwatch);
  watch.WaitForEnd();
  return watch.Reap();
}

std::string SignalName(int signal) {
  const char* name = sigabbrev_np(signal);
  const char* text = sigdescr_np(signal);
  if (name == nullptr || text == nullptr) return "signal " + std::to_string(signal);
  std::string description = text;
  if (!description.empty()) description[0] = static_cast<char>(description[0] | 0x20);
  return std::string("SIG") + name + " (" + description + ")";
}

}  // namespace facetless
