// The threads for the requests of one listener. The number of short requests that run at the same time is
// limited to what the processors can serve: if a hundred threads competed for two processors, each would wait
// for ninety-eight others, and one request in a hundred would take a hundred times as long as the rest.
// Requests that wait for a job or for a slow sender do not count towards this limit.
//
//  1. Tasks start in the order in which they arrive.
//  2. At any time, at most `processors` × 2 tasks are younger than a few milliseconds. Older tasks are
//     assumed to be waiting.
//  3. At most `threads` tasks run at the same time. Law 2 delays a task by about a millisecond for each
//     waiting task ahead of it.
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
  ~WorkerPool();  // calls Shutdown
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void Run(std::function<void()> task);
  // Runs all waiting tasks, and returns when they have ended.
  void Shutdown();

 private:
  using Clock = std::chrono::steady_clock;

  void Work(std::size_t thread);
  bool MayBegin() const;

  const int young_limit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<Clock::time_point> began_;  // start of each thread's task; long ago if the thread has none
  bool watched_ = false;                  // a thread is waiting for a task to pass the age limit
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace facetless
