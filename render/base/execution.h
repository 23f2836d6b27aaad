// Execution: the number of threads that a computation may use, and the flag that cancels it.
//
//     std::atomic<bool> stop = false;
//     auto answer = TraceDirect(scene, camera, {.execution = {.threads = 4, .cancel = &stop}});
#pragma once

#include <atomic>

namespace facetless {

struct Execution {
  int threads = 0;  // 0: one per core
  const std::atomic<bool>* cancel =
      nullptr;  // polled if not null; the work ends with kCancelled once it is true

  // Returns the same threads with another flag, which belongs to a time limit that watches this flag.
  Execution WithFlag(const std::atomic<bool>* flag) const { return {threads, flag}; }
  bool cancelled() const { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }
};

}  // namespace facetless
