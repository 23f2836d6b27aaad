// How a piece of work is to be run: on how many threads, and until when.
#pragma once

#include <atomic>

namespace facetless {

struct Execution {
  int threads = 0;                            // 0: all cores
  const std::atomic<bool>* cancel = nullptr;  // polled; true ends the work with kCancelled

  bool cancelled() const { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }
};

}  // namespace facetless
