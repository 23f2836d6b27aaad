// Stopping work on signals and deadlines. Both set a flag that long computations poll.
//
//     Deadline deadline(/*seconds=*/60, &InterruptFlag());
//     auto result = TraceDirect(scene, camera, {.execution = {.cancel = deadline.flag()}});
//     if (!result && deadline.expired()) return TimeoutError();
//
//  1. The first SIGINT, SIGTERM or SIGHUP sets the flag. Work then ends, child processes are killed and
//     temporary files are removed. A second signal ends the process at once; child processes die with it
//     (child_process.h).
//  2. The flag of a Deadline is set when its time is over or when the flag that it watches is set; expired()
//     distinguishes the two. Start restarts the clock, for work whose time begins later than its flag is
//     needed.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace facetless {

// Installs the signal handlers, and ignores SIGPIPE from then on. Call it once, from main.
void InstallInterruptHandlers();
// The flag that the first signal sets. It is valid for the lifetime of the process.
const std::atomic<bool>& InterruptFlag();
// The signal that set the flag, or 0.
int InterruptSignal();

class Deadline {
 public:
  // `seconds` <= 0 means no time limit. `watched` may be null; it must outlive the Deadline.
  Deadline(double seconds, const std::atomic<bool>* watched);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  // Restarts the clock: the time is over `seconds` from now; <= 0 means no time limit.
  void Start(double seconds);
  // Ends the time now.
  void Expire();
  const std::atomic<bool>* flag() const { return &stop_; }
  // Returns whether the flag was set because the time was over.
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
