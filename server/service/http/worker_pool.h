// Threads for the requests of one listener. Of requests that take no time, as many run at once as the
// processors can serve: a hundred threads that all want two processors each wait for ninety-eight others, and
// one request in a hundred waits a hundred times as long as the rest. Requests that wait themselves, for a
// job or for a slow sender, are not counted among those.
//
//  1. Tasks begin in the order in which they came.
//  2. At most `processors` × 2 tasks are younger than a few milliseconds at any time; older ones are taken to
//     be waiting for somebody.
//  3. At most `threads` tasks run at once. Law 2 delays a task by a millisecond or so for each one ahead of
//     it that waits itself.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace facetless {

class WorkerPool {
 public:
  explicit WorkerPool(int threads);
  ~WorkerPool();  // as Shutdown
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void Run(std::function<void()> task);
  // Runs what is waiting to its end, and returns then.
  void Shutdown();

 private:
  using Clock = std::chrono::steady_clock;

  void Work(std::size_t thread);
  bool MayBegin() const;

  const int young_limit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<Clock::time_point> began_;  // of each thread's task; long ago: it has none
  bool watched_ = false;                  // a thread waits for a task to grow old
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace facetless
