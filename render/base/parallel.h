// Parallel loops: the only file that knows oneTBB.
//
//  1. A loop returns when all its bodies have ended. Bodies see what the caller wrote before the loop, and
//     the caller sees what they wrote after it. Nothing orders the bodies of one loop among each other: two
//     that touch the same memory are a race if one of them writes.
//  2. A body may start another loop. While it waits there, its thread may take up other bodies, of the outer
//     loop too: nothing that belongs to a thread (PerThread) is held across a loop.
//  3. An exception in a body ends the loop, and leaves it as if thrown by the caller.
//  4. oneTBB comes without the thread sanitizer's instrumentation, which therefore sees none of the
//     synchronisation inside the library. A build with that sanitizer is told law 1 here, and no more: two
//     bodies that race are still reported (tests/unit/trace/parallel_test.cpp). What the library does to its
//     own tasks is left out by tools/tsan.supp, and what it leaves on the caller's stack by RunLoop below.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace facetless {

// A T for each thread that asks for its own by local(); after the loop, iterate over all of them.
template <typename T>
using PerThread = tbb::enumerable_thread_specific<T>;

// A piece of work that threads hand to each other: Run from any of them between the making and the end of
// this object, which are on the thread that waits for it. The loops below use it, and who gives work to
// another library that runs it on oneTBB's threads. The two addresses stand for its two facts: the caller's
// writes come before each body, and each body's writes before the caller's return. One address for both would
// order the bodies too, and hide their races.
template <typename Body>
class SharedWork {
 public:
  explicit SharedWork(const Body& body) : body_(body) { Release(&handed_out_); }
  ~SharedWork() { Acquire(&handed_in_); }
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;

  template <typename... Arguments>
  void Run(Arguments... arguments) const {
    Acquire(&handed_out_);
    const Returning returning{this};
    body_(arguments...);
  }

 private:
  struct Returning {  // also where the body throws
    const SharedWork* work;
    ~Returning() { Release(&work->handed_in_); }
  };

#if defined(__SANITIZE_THREAD__)
  static void Acquire(const char* address) {
    __tsan_acquire(const_cast<char*>(address));
  }
  static void Release(const char* address) {
    __tsan_release(const_cast<char*>(address));
  }
#else
  static void Acquire(const char*) {}
  static void Release(const char*) {}
#endif

  const Body& body_;
  alignas(8) char handed_out_ = 0;
  alignas(8) char handed_in_ = 0;
};

// Runs loop(), which starts a loop of oneTBB and waits for it. The library counts the end of a loop in a
// place on the waiting thread's stack. Its last thread leaves that place by an atomic operation that the
// sanitizer sees, but the waiting itself is inside the library: to the sanitizer whatever lies there next
// seems to race with the loop that is over, and by then the report may have lost the frames that
// tools/tsan.supp knows. So who waited takes up what was handed in anywhere on the frames below, which are
// nobody's any more. Only atomics hand in anything: a body that wrote there without one is still reported.
#if defined(__SANITIZE_THREAD__)
template <typename Loop>
[[gnu::noinline]] void RunLoop(const Loop& loop) {
  struct Ended {  // also where a body throws
    char* frame;
    ~Ended() {
      constexpr int kFrames = 4096;  // bytes; those between here and the library take a tenth of it
      for (int below = 8; below <= kFrames; below += 8) __tsan_acquire(frame - below);
    }
  };
  const Ended ended{static_cast<char*>(__builtin_frame_address(0))};
  loop();
}
#else
template <typename Loop>
void RunLoop(const Loop& loop) {
  loop();
}
#endif

// body(i) for begin ≤ i < end.
template <typename Index, typename Body>
void ParallelFor(Index begin, Index end, const Body& body) {
  if (!(begin < end)) return;
  const auto all_of = [&body](Index first, Index last) {
    for (Index i = first; i < last; ++i) body(i);
  };
  const SharedWork work(all_of);
  RunLoop([&] {
    tbb::parallel_for(tbb::blocked_range<Index>(begin, end), [&work](const tbb::blocked_range<Index>& block) {
      work.Run(block.begin(), block.end());
    });
  });
}

// body(first, last) for blocks that make up begin ≤ i < end; a block of more than `grain` indices may be
// halved.
template <typename Body>
void ParallelForBlocks(std::size_t begin, std::size_t end, std::size_t grain, const Body& body) {
  if (!(begin < end)) return;
  const SharedWork work(body);
  RunLoop([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(begin, end, grain),
        [&work](const tbb::blocked_range<std::size_t>& block) { work.Run(block.begin(), block.end()); });
  });
}

// body(row, row_end, column, column_end) for tiles of at most tile × tile that make up rows × columns.
template <typename Body>
void ParallelForTiles(int rows, int columns, int tile, const Body& body) {
  if (rows <= 0 || columns <= 0) return;
  const SharedWork work(body);
  RunLoop([&] {
    tbb::parallel_for(
        tbb::blocked_range2d<int>(0, rows, tile, 0, columns, tile),
        [&work](const tbb::blocked_range2d<int>& part) {
          work.Run(part.rows().begin(), part.rows().end(), part.cols().begin(), part.cols().end());
        },
        tbb::simple_partitioner());
  });
}

// Sorts; elements that compare equal come in any order.
template <typename Iterator, typename Less>
void ParallelSort(Iterator begin, Iterator end, const Less& less) {
#if defined(__SANITIZE_THREAD__)
  // oneTBB's own moves of elements can't be announced.
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

// Runs body() with this many threads for its loops, 0 for as many as there are cores.
template <typename Body>
void RunWithThreads(int threads, const Body& body) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const SharedWork work(body);
  arena.execute([&work] { work.Run(); });
}

}  // namespace facetless
