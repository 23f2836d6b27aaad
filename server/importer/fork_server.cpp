#include "server/importer/fork_server.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <utility>

#include "render/base/stopwatch.h"

namespace facetless {
namespace {

// The time in which the process must have loaded its libraries, on a machine that is busy with other things.
constexpr double kStartSeconds = 60;
constexpr double kPauseSeconds = 1;  // between two starts
constexpr int kFailuresAllowed = 3;  // in a row, to become ready

std::vector<char*> Pointers(const std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (const std::string& s : strings) pointers.push_back(const_cast<char*>(s.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

int Milliseconds(double seconds) {
  return static_cast<int>(seconds * 1000);
}

// Waits until `fd` has something to read or its other end is closed. Returns false when the time is over.
bool WaitToRead(int fd, double seconds) {
  const Stopwatch stopwatch;
  for (;;) {
    struct pollfd watched = {fd, POLLIN, 0};
    const int ready = poll(&watched, 1, Milliseconds(std::max(0.0, seconds - stopwatch.Seconds())));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

// The id of the child that a fork server has forked, which the child writes first. Nothing if no child was forked;
// `*timed_out` if neither is known in time.
std::optional<pid_t> ReadChild(int report, double seconds, bool* timed_out) {
  *timed_out = !WaitToRead(report, seconds);
  if (*timed_out) return std::nullopt;
  pid_t child = 0;
  if (read(report, &child, sizeof child) != sizeof child) return std::nullopt;
  return child;
}

}  // namespace

ForkServer::ForkServer(ForkServerSettings settings) : settings_(std::move(settings)) {
  if (!wake_.Open()) return;
  thread_ = std::thread([this] { Run(); });
}

ForkServer::~ForkServer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
  }
  wake_.write.Close();
  if (thread_.joinable()) thread_.join();
}

std::optional<pid_t> ForkServer::Start(const ForkRequest& request, const ChildStreams& streams,
                                       Descriptor& report) {
  std::shared_ptr<Descriptor> socket;
  {
    const std::lock_guard lock(mutex_);
    if (ready_ == 0) return std::nullopt;
    socket = socket_;
  }
  Pipe pipe;
  if (!pipe.Open()) return std::nullopt;
  if (!SendForkRequest(socket->get(), request, {streams.in, streams.out, streams.error, pipe.write.get()}))
    return std::nullopt;
  pipe.write.Close();
  bool timed_out = false;
  std::optional<pid_t> child = ReadChild(pipe.read.get(), settings_.answer_seconds, &timed_out);
  if (timed_out) {
    // Replace a process that does not answer. Once it is dead, either there is a child, or there will be none.
    {
      const std::lock_guard lock(mutex_);
      if (socket == socket_) replacing_ = true;
    }
    [[maybe_unused]] const ssize_t woken = write(wake_.write.get(), "", 1);
    child = ReadChild(pipe.read.get(), settings_.answer_seconds, &timed_out);
  }
  if (!child) return std::nullopt;
  fcntl(pipe.read.get(), F_SETFL, O_NONBLOCK);
  report = std::move(pipe.read);
  return child;
}

pid_t ForkServer::WaitForProcess(double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return ready_ != 0; });
  return ready_;
}

// ---- The thread ----

void ForkServer::Run() {
  for (int failures = 0; failures < kFailuresAllowed;) {
    const bool was_ready = Launch() && BecomesReady();
    failures = was_ready ? 0 : failures + 1;
    WatchToItsEnd();
    if (!PauseUnlessStopping(kPauseSeconds)) return;
    if (was_ready) Log("the loaded importer has ended, and is loaded again");
  }
  Log("no importer stays loaded, because " + settings_.program +
      " did not become ready: it is started for each file");
}

bool ForkServer::Launch() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return false;
  const auto ours = std::make_shared<Descriptor>(ends[0]);
  const Descriptor theirs(ends[1]), null(open("/dev/null", O_RDWR | O_CLOEXEC));
  std::vector<std::string> words = {settings_.program, kServeForks}, environment = settings_.environment;
  const std::vector<char*> arguments = Pointers(words), variables = Pointers(environment);
  Confinement confinement;
  confinement.working_directory = "/";
  confinement.parent = getpid();

  // Fork with every signal blocked, so that no handler of the parent runs in the child.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  process_ = fork();
  if (process_ == 0) {
    static_assert(kForkSocket == kReportDescriptor);
    ConfineChild(confinement, {null.get(), null.get(), null.get(), theirs.get()});
    if (fcntl(kForkSocket, F_SETFD, 0) == 0) execve(arguments.front(), arguments.data(), variables.data());
    EndUnconfined(kForkSocket);
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (process_ < 0) return false;
  const std::lock_guard lock(mutex_);
  socket_ = ours;
  replacing_ = false;
  return true;
}

bool ForkServer::BecomesReady() {
  struct pollfd watched[2] = {{socket_->get(), POLLIN, 0}, {wake_.read.get(), POLLIN, 0}};
  const Stopwatch stopwatch;
  int ready = 0;
  do ready = poll(watched, 2, Milliseconds(kStartSeconds - stopwatch.Seconds()));
  while (ready < 0 && errno == EINTR);
  char said[sizeof(int)] = {};
  if (watched[0].revents == 0 || read(socket_->get(), said, sizeof said) != 1 || said[0] != kForkServerReady)
    return false;
  const std::lock_guard lock(mutex_);
  ready_ = process_;
  changed_.notify_all();
  return true;
}

void ForkServer::WatchToItsEnd() {
  if (process_ <= 0) return;
  // Use the system call directly, because this C library declares its wrapper without C linkage.
  const Descriptor process(static_cast<int>(syscall(SYS_pidfd_open, process_, 0)));
  const auto wanted = [&] {
    const std::lock_guard lock(mutex_);
    return ready_ != 0 && !stopping_ && !replacing_;
  };
  while (wanted()) {
    struct pollfd watched[2] = {{process.get(), POLLIN, 0}, {wake_.read.get(), POLLIN, 0}};
    if (poll(watched, 2, -1) < 0 && errno != EINTR) break;
    if (watched[0].revents != 0) break;
    char woken = 0;
    if (watched[1].revents != 0 && read(wake_.read.get(), &woken, 1) <= 0) break;
  }
  {
    const std::lock_guard lock(mutex_);
    ready_ = 0;
    socket_.reset();
  }
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
  process_ = 0;
}

// Returns false at the end of the ForkServer.
bool ForkServer::PauseUnlessStopping(double seconds) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return stopping_; });
}

void ForkServer::Log(const std::string& sentence) const {
  if (settings_.log) settings_.log(sentence);
}

}  // namespace facetless
