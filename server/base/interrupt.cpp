#include "server/base/interrupt.h"

#include <chrono>
#include <csignal>
#include <optional>

namespace facetless {
namespace {

std::atomic<bool> interrupt_flag{false};
std::atomic<int> interrupt_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may touch lock-free atomics only");

void HandleSignal(int signal) {
  if (interrupt_flag.exchange(true)) {
    // On the second signal, take the default action, which ends the process.
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return;
  }
  interrupt_signal = signal;
}

}  // namespace

void InstallInterruptHandlers() {
  struct sigaction action = {};
  action.sa_handler = HandleSignal;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

const std::atomic<bool>& InterruptFlag() {
  return interrupt_flag;
}
int InterruptSignal() {
  return interrupt_signal;
}

Deadline::Deadline(double seconds, const std::atomic<bool>* watched) {
  Start(seconds);
  thread_ = std::thread([this, watched] {
    std::unique_lock lock(mutex_);
    while (!done_) {
      if (watched != nullptr && *watched) {
        stop_ = true;
        return;
      }
      if (end_ && std::chrono::steady_clock::now() >= *end_) {
        expired_ = true;
        stop_ = true;
        return;
      }
      // A signal handler cannot notify a condition variable, so poll the watched flag.
      changed_.wait_for(lock, std::chrono::milliseconds(20));
    }
  });
}

void Deadline::Expire() {
  const std::lock_guard lock(mutex_);
  expired_ = true;
  stop_ = true;
}

void Deadline::Start(double seconds) {
  using Clock = std::chrono::steady_clock;
  const std::lock_guard lock(mutex_);
  end_.reset();
  if (seconds > 0)
    end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

Deadline::~Deadline() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

}  // namespace facetless
