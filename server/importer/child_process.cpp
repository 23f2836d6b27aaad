#include "server/importer/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
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
#include "sandbox/fork_requests.h"
#include "server/importer/descriptor.h"
#include "server/importer/directory_use.h"
#include "server/importer/fork_server.h"

namespace facetless {
namespace {

// The interval at which the cancel flag, the wall clock and the watched limits are checked.
constexpr int kPollMs = 20;

std::vector<char*> Pointers(const std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  pointers.reserve(strings.size() + 1);
  for (const std::string& s : strings) pointers.push_back(const_cast<char*>(s.c_str()));
  pointers.push_back(nullptr);
  return pointers;
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

// The streams between parent and child, with the ends of both. `report` tells why the child could not start, and is
// closed when it runs.
struct ChildPipes {
  Descriptor null;
  Pipe out, err, report;
  bool Open() {
    null = Descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC));
    if (null.get() < 0 || !out.Open() || !err.Open() || !report.Open()) return false;
    for (const Pipe* pipe : {&out, &err, &report}) fcntl(pipe->read.get(), F_SETFL, O_NONBLOCK);
    return true;
  }
  ChildStreams Streams() const { return {null.get(), out.write.get(), err.write.get(), report.write.get()}; }
  void CloseWriteEnds() {
    out.write.Close();
    err.write.Close();
    report.write.Close();
  }
};

ForkRequest ToForkRequest(const ChildRequest& request) {
  ForkRequest fork;
  fork.arguments = {request.program};
  fork.arguments.insert(fork.arguments.end(), request.arguments.begin(), request.arguments.end());
  fork.environment = request.environment;
  fork.confinement.working_directory = request.working_directory;
  fork.confinement.limits = request.limits;
  fork.confinement.syscall_filter = request.syscall_filter;
  fork.confinement.file_access = request.file_access;
  if (request.limits.threads > 0) fork.confinement.tasks_before = TasksOfMachine();
  fork.confinement.parent = getpid();
  return fork;
}

// Forks, and executes the program. Returns the child's id, or -1 with errno set.
pid_t ForkAndExec(ForkRequest& request, const ChildStreams& streams) {
  const std::vector<char*> arguments = Pointers(request.arguments);
  const std::vector<char*> environment = Pointers(request.environment);
  // Fork with every signal blocked, so that no handler of the parent runs in the child.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = fork();
  const int fork_error = errno;
  if (child == 0) {
    ConfineChild(request.confinement, streams);
    execve(arguments.front(), arguments.data(), environment.data());
    EndUnconfined(kReportDescriptor);
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = fork_error;
  return child;
}

struct StartedChild {
  pid_t id = -1;
  bool forked = false;  // by the fork server
};

// Starts the child, by the fork server if it can. If the child cannot be started, its id is -1 and errno is set.
StartedChild StartChild(const ChildRequest& request, ChildPipes& pipes) {
  ForkRequest fork = ToForkRequest(request);
  StartedChild child;
  if (request.fork_server != nullptr && request.fork_server->program() == request.program) {
    child.id = request.fork_server->Start(fork, pipes.Streams(), pipes.report.read).value_or(-1);
    child.forked = child.id > 0;
  }
  if (!child.forked) child.id = ForkAndExec(fork, pipes.Streams());
  const int start_error = errno;
  // Both processes create the group, so that it exists whichever of them runs first. This call fails if the
  // child has already called exec, which does no harm.
  if (child.id > 0) setpgid(child.id, child.id);
  errno = start_error;
  return child;
}

// Watches a child from its start to its end: its streams, the clock, the cancel flag and the limits.
class ChildWatch {
 public:
  ChildWatch(const ChildRequest& request, const ChildPipes& pipes, const StartedChild& child,
             const Stopwatch& stopwatch)
      : request_(request),
        pipes_(pipes),
        child_(child.id),
        stopwatch_(stopwatch),
        // Use the system call directly, because this C library declares its wrapper without C linkage.
        process_(static_cast<int>(syscall(SYS_pidfd_open, child.id, 0))),
        error_stream_(request) {
    outcome_.forked = child.forked;
  }

  // Returns when the child has ended. A child that exceeds a limit is killed.
  void WaitForEnd() {
    for (bool running = true; running;) {
      struct pollfd watched[3] = {{out_open_ ? pipes_.out.read.get() : -1, POLLIN, 0},
                                  {err_open_ ? pipes_.err.read.get() : -1, POLLIN, 0},
                                  {process_.get(), POLLIN, 0}};
      poll(watched, 3, kPollMs);
      if (watched[0].revents != 0) DrainOut();
      if (watched[1].revents != 0) DrainErr();
      // The child runs when the report pipe is closed.
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
  const Descriptor process_;
  ErrorStream error_stream_;
  StatusSamples samples_;
  ChildOutcome outcome_;
  bool out_open_ = true, err_open_ = true, started_ = false, killed_ = false;
  int start_error_ = 0;  // errno of the child, if it could not call exec
};

}  // namespace

Result<ChildOutcome> RunChild(const ChildRequest& request) {
  ChildPipes pipes;
  if (!pipes.Open()) return CannotStart(request, errno);
  const Stopwatch stopwatch;
  const StartedChild child = StartChild(request, pipes);
  if (child.id < 0) return CannotStart(request, errno);
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
