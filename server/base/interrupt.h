// Stopping: signals from the user, and deadlines. Both end in one flag that long work polls.
//
//  1. The first SIGINT, SIGTERM or SIGHUP sets the flag, so that work unwinds, children are killed and
//     temporary files removed. A second one ends the process at once (children die with it: see
//     child_process.h).
//  2. A Deadline's flag is set when its time is over or when the flag that it watches is set; expired() tells
//     which. Start sets its time anew, for work whose clock begins later than its flag is needed.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace facetless {

// Installs the handlers; SIGPIPE is ignored from then on. Call it once, from main.
void InstallInterruptHandlers();
// Set by the first signal. Valid for the life of the process.
const std::atomic<bool>& InterruptFlag();
// The signal that set the flag, or 0.
int InterruptSignal();

class Deadline {
 public:
  // `seconds` <= 0: no limit of time. `watched` may be null; it must outlive the Deadline.
  Deadline(double seconds, const std::atomic<bool>* watched);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  // From now on `seconds`; <= 0: no limit.
  void Start(double seconds);
  // The time is over now.
  void Expire();
  const std::atomic<bool>* flag() const { return &stop_; }
  // True if the flag was set because the time was over.
  bool expired() const { return expired_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<bool> expired_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::chrono::steady_clock::time_point> end_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace facetless
