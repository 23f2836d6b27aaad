// Parallel loops (render/base/parallel.h), numbered by its laws. Under the thread sanitizer, every test here
// also checks that only real races are reported.
#include "render/base/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace facetless {
namespace {

constexpr int kCount = 10'000;

// Law 1.

TEST(Parallel, ALoopVisitsEachIndexOnce) {
  std::vector<int> visits(kCount, 0);
  std::vector<int> source(kCount);
  std::iota(source.begin(), source.end(), 0);
  ParallelFor(0, kCount, [&](int i) { visits[i] += 1 + source[i]; });
  for (int i = 0; i < kCount; ++i) ASSERT_EQ(visits[i], 1 + i);
}

TEST(Parallel, BlocksMakeUpTheWhole) {
  std::vector<int> visits(kCount, 0);
  ParallelForBlocks(7, kCount, 100, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) ++visits[i];
  });
  for (int i = 0; i < kCount; ++i) ASSERT_EQ(visits[i], i < 7 ? 0 : 1);
}

TEST(Parallel, TilesMakeUpTheWholeAndAreNoLarger) {
  constexpr int kRows = 70, kColumns = 131, kTile = 32;
  std::vector<int> visits(kRows * kColumns, 0);
  std::atomic<int> larger{0};
  ParallelForTiles(kRows, kColumns, kTile, [&](int row, int row_end, int column, int column_end) {
    if (row_end - row > kTile || column_end - column > kTile) ++larger;
    for (int y = row; y < row_end; ++y)
      for (int x = column; x < column_end; ++x) ++visits[y * kColumns + x];
  });
  EXPECT_EQ(larger, 0);
  EXPECT_EQ(std::set<int>(visits.begin(), visits.end()), std::set<int>{1});
}

TEST(Parallel, AnEmptyLoopDoesNothing) {
  const auto never = [](auto...) { FAIL(); };
  ParallelFor(3u, 3u, never);
  ParallelFor(3, 2, never);
  ParallelForBlocks(5, 4, 1, never);
  ParallelForTiles(0, 5, 4, never);
}

TEST(Parallel, SortsLikeTheStandardLibrary) {
  std::vector<unsigned> values(kCount);
  unsigned value = 1;
  for (unsigned& v : values) v = value = value * 1664525 + 1013904223;
  std::vector<unsigned> expected = values;
  std::sort(expected.begin(), expected.end(), std::greater<>());
  ParallelSort(values.begin(), values.end(), std::greater<>());
  EXPECT_EQ(values, expected);
}

TEST(Parallel, WhatThreadsKeptAddsUp) {
  PerThread<std::vector<int>> kept;
  ParallelFor(0, kCount, [&](int i) { kept.local().push_back(i); });
  std::vector<int> all;
  for (const std::vector<int>& some : kept) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), std::size_t{kCount});
  for (int i = 0; i < kCount; ++i) ASSERT_EQ(all[i], i);
}

TEST(Parallel, OneThreadIsTheCaller) {
  std::set<std::thread::id> seen;
  RunWithThreads(1, [&] { ParallelFor(0, kCount, [&](int) { seen.insert(std::this_thread::get_id()); }); });
  EXPECT_EQ(seen.size(), 1u);
}

TEST(Parallel, LoopsOfSeveralCallersDoNotMix) {
  std::vector<std::vector<int>> visits(3, std::vector<int>(kCount, 0));
  std::vector<std::thread> callers;
  for (std::vector<int>& own : visits) {
    callers.emplace_back([&own] {
      for (int round = 0; round < 10; ++round)
        RunWithThreads(2, [&] { ParallelFor(0, kCount, [&](int i) { ++own[i]; }); });
    });
  }
  for (std::thread& caller : callers) caller.join();
  for (const std::vector<int>& own : visits)
    EXPECT_EQ(std::set<int>(own.begin(), own.end()), std::set<int>{10});
}

// Writes and reads `depth` stack frames of half a KiB below the caller's frame.
[[gnu::noinline]] int UseTheStack(int depth) {
  std::array<unsigned char, 512> frame;
  unsigned char* volatile escaped = frame.data();  // without this, the sanitizer build removes the frame
  std::fill_n(escaped, frame.size(), static_cast<unsigned char>(depth));
  return escaped[7] + (depth > 0 ? UseTheStack(depth - 1) : 0);
}

// The thread sanitizer remembers only the recent accesses of a thread. If it has forgotten an older access,
// it cannot match the frames that tools/tsan.supp names. Therefore another caller keeps the threads busy
// between the end of a loop and the next use of its stack. With history_size=7 the sanitizer remembers some
// millions of accesses, and this test finds little; with history_size=0 it found the race because of which
// RunLoop exists.
TEST(Parallel, WhatALoopUsedOfTheStackIsTheCallersAgain) {
  std::atomic<bool> ended{false};
  std::thread other([&ended] {
    while (!ended) {
      ParallelFor(0, 64, [](int i) {
        volatile int sum = i;
        for (int j = 0; j < 3000; ++j) sum = sum + j;
      });
    }
  });
  std::vector<int> visits(64, 0);
  for (int round = 0; round < 40; ++round) {
    ParallelFor(0, 64, [&visits](int i) {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      ++visits[i];
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(UseTheStack(8), 8 * 9 / 2);
  }
  ended = true;
  other.join();
  EXPECT_EQ(visits, std::vector<int>(64, 40));
}

// Law 2.

TEST(Parallel, LoopsInLoopsSeeWhatEachOtherWrote) {
  constexpr int kOuter = 40, kInner = 500;
  std::vector<std::vector<int>> rows(kOuter);
  std::vector<int> sums(kOuter, 0);
  ParallelFor(0, kOuter, [&](int i) {
    rows[i].assign(kInner, i);
    ParallelFor(0, kInner, [&, i](int j) { rows[i][j] += j; });
    sums[i] = std::accumulate(rows[i].begin(), rows[i].end(), 0);
  });
  for (int i = 0; i < kOuter; ++i) EXPECT_EQ(sums[i], i * kInner + kInner * (kInner - 1) / 2);
}

// Law 3.

TEST(Parallel, AnExceptionReachesTheCaller) {
  const auto work = [](int i) {
    if (i == kCount / 2) throw std::runtime_error("half way");
  };
  EXPECT_THROW(ParallelFor(0, kCount, work), std::runtime_error);
  EXPECT_THROW(RunWithThreads(2, [&] { ParallelFor(0, kCount, work); }), std::runtime_error);
}

// Law 4.

// Two bodies that run at the same time on two threads, and count in the same variable without
// synchronisation.
[[maybe_unused]] int CountByTwoBodies() {
  int count = 0;
  std::atomic<int> begun{0};
  std::atomic<bool> counted{false};
  RunWithThreads(2, [&] {
    ParallelFor(0, 2, [&](int i) {
      begun.fetch_add(1, std::memory_order_relaxed);  // relaxed, so that it orders nothing
      while (begun.load(std::memory_order_relaxed) < 2) std::this_thread::yield();
      // The second body waits for the first, because the sanitizer may miss accesses at exactly the same
      // time.
      while (i == 1 && !counted.load(std::memory_order_relaxed)) std::this_thread::yield();
      ++count;
      counted.store(true, std::memory_order_relaxed);
    });
  });
  return count;
}

TEST(ParallelDeathTest, TheThreadSanitizerStillReportsARaceOfBodies) {
#if !defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "needs a build with the thread sanitizer";
#endif
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "needs two cores";
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  // The sanitizer's exit code is 66, both if it stops at the first report and if it continues to the end.
  EXPECT_EXIT(
      {
        CountByTwoBodies();
        std::exit(0);
      },
      testing::ExitedWithCode(66), "data race");
}

}  // namespace
}  // namespace facetless
