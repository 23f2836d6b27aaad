#include "server/service/http/worker_pool.h"

#include <algorithm>
#include <utility>

namespace facetless {
namespace {

// A task that has run for longer than this is assumed to be waiting. A stored answer takes a tenth of this
// time.
constexpr auto kYoung = std::chrono::milliseconds(4);

}  // namespace

WorkerPool::WorkerPool(int threads)
    : young_limit_(2 * std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
      began_(static_cast<std::size_t>(threads)) {
  for (std::size_t i = 0; i < began_.size(); ++i) threads_.emplace_back([this, i] { Work(i); });
}

WorkerPool::~WorkerPool() {
  Shutdown();
}

void WorkerPool::Run(std::function<void()> task) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
    wake = !watched_ || MayBegin();
  }
  if (wake) changed_.notify_one();
}

void WorkerPool::Shutdown() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

bool WorkerPool::MayBegin() const {
  const auto old = Clock::now() - kYoung;
  return std::count_if(began_.begin(), began_.end(), [old](auto began) { return began > old; }) <
         young_limit_;
}

void WorkerPool::Work(std::size_t thread) {
  std::unique_lock lock(mutex_);
  while (!ending_ || !tasks_.empty()) {
    if (tasks_.empty() || (watched_ && !MayBegin())) {
      changed_.wait(lock);
    } else if (!MayBegin()) {
      watched_ = true;
      changed_.wait_for(lock, kYoung);
      watched_ = false;
    } else {
      const auto task = std::move(tasks_.front());
      tasks_.pop_front();
      began_[thread] = Clock::now();
      // Another thread must watch for the next task, because all running tasks may be waiting.
      const bool leave_watch = !tasks_.empty() && !watched_;
      lock.unlock();
      if (leave_watch) changed_.notify_one();
      task();
      lock.lock();
      began_[thread] = {};
    }
  }
  changed_.notify_all();  // the last task has ended, so the other threads end, too
}

}  // namespace facetless
