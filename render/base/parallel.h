// Parallel loops. This is the only file that uses oneTBB directly.
//
//     PerThread<std::uint64_t> sums;
//     ParallelFor(0, rows, [&](int row) { sums.local() += CountHits(row); });
//     for (const std::uint64_t sum : sums) total += sum;
//
//  1. A loop returns when all its bodies have ended. The bodies see everything that the caller wrote before
//     the loop, and the caller sees everything that the bodies wrote. The bodies of one loop are not ordered
//     among each other: if two of them access the same memory and one writes, that is a data race.
//  2. A body may start another loop. While it waits for that loop, its thread may run other bodies, including
//     bodies of the outer loop. Code must therefore not hold a reference to per-thread data (PerThread)
//     across a loop.
//  3. An exception in a body ends the loop and propagates to the caller.
//  4. The oneTBB library is not built with the thread sanitizer's instrumentation, so the sanitizer sees none
//     of its internal synchronisation. In a sanitized build this file declares law 1 to the sanitizer, and
//     nothing more: a race between two bodies is still reported (tests/unit/trace/parallel_test.cpp).
//     tools/tsan.supp suppresses reports about the library's own tasks, and RunLoop below those about data
//     that the library leaves on the caller's stack.
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

// One T for each thread that calls local(). After the loop, iterate over all of them.
template <typename T>
using PerThread = tbb::enumerable_thread_specific<T>;

// Work that one thread hands to others. The waiting thread constructs and destroys this object; between the
// two, any thread may call Run. The loops below use it, and so does code that hands work to another library
// that runs it on oneTBB's threads. The two addresses declare two orderings to the sanitizer: the caller's
// writes happen before each body, and each body's writes happen before the caller continues. A single address
// for both would order the bodies among each other as well, and hide their races.
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
  struct Returning {  // runs even if the body throws
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

// Runs loop(), which starts a loop of oneTBB and waits for it. The library keeps the loop's completion
// counter on the stack of the waiting thread. The last worker thread releases the counter with an atomic
// operation, which the sanitizer sees, but the waiting happens inside the library, which it does not see.
// Whatever is later stored at the same stack address therefore seems to race with the finished loop, and the
// report may no longer contain the frames that tools/tsan.supp matches. To prevent that, the waiting thread
// acquires every address in the stack frames below its own, which are dead by then. Only atomic operations
// release an address: a body that wrote there without one is still reported.
#if defined(__SANITIZE_THREAD__)
template <typename Loop>
[[gnu::noinline]] void RunLoop(const Loop& loop) {
  struct Ended {  // runs even if a body throws
    char* frame;
    ~Ended() {
      constexpr int kFrames =
          4096;  // bytes; the frames between here and the library take about a tenth of this
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

// Calls body(i) for begin ≤ i < end.
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

// Calls body(first, last) for disjoint blocks that cover begin ≤ i < end. Blocks of more than `grain` indices
// may be split further.
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

// Calls body(row, row_end, column, column_end) for disjoint tiles of at most tile × tile elements that cover
// rows × columns.
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

// Sorts the elements. The order of elements that compare equal is unspecified.
template <typename Iterator, typename Less>
void ParallelSort(Iterator begin, Iterator end, const Less& less) {
#if defined(__SANITIZE_THREAD__)
  // The moves of elements inside oneTBB cannot be declared to the sanitizer.
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

// Runs body(); the loops that it starts use this many threads, or one per core if `threads` is 0.
template <typename Body>
void RunWithThreads(int threads, const Body& body) {
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  const SharedWork work(body);
  arena.execute([&work] { work.Run(); });
}

}  // namespace facetless
