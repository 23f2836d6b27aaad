#include "server/service/http/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

namespace facetless {
namespace {

TEST(WorkerPool, BeginsTasksInTheirOrder) {
  std::vector<int> order, expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  WorkerPool pool(1);
  for (int i = 0; i < 1000; ++i) pool.Run([&order, i] { order.push_back(i); });
  pool.Shutdown();
  EXPECT_EQ(order, expected);
}

TEST(WorkerPool, RunsAllThatWaitsBeforeItEnds) {
  std::atomic<int> done{0};
  WorkerPool pool(16);
  for (int i = 0; i < 10000; ++i) pool.Run([&done] { ++done; });
  pool.Shutdown();
  EXPECT_EQ(done, 10000);
}

TEST(WorkerPool, EndsWhereNothingEverRan) {
  WorkerPool pool(100);
}

TEST(WorkerPool, ThoseThatWaitForEachOtherAllRun) {
  // There are as many jobs as threads, far more than processors. None ends before the last one has begun.
  constexpr int kThreads = 64;
  std::latch all(kThreads);
  WorkerPool pool(kThreads);
  for (int i = 0; i < kThreads; ++i) pool.Run([&all] { all.arrive_and_wait(); });
  pool.Shutdown();
  EXPECT_TRUE(all.try_wait());
}

TEST(WorkerPool, OneThatComesLastPassesThoseThatWait) {
  constexpr int kThreads = 32;
  std::latch last(1);
  std::atomic<int> done{0};
  WorkerPool pool(kThreads);
  for (int i = 0; i + 1 < kThreads; ++i) {
    pool.Run([&] {
      last.wait();
      ++done;
    });
  }
  pool.Run([&] {
    EXPECT_EQ(done, 0);
    last.count_down();
  });
  pool.Shutdown();
  EXPECT_EQ(done, kThreads - 1);
}

TEST(WorkerPool, NoMoreRunAtOnceThanItHasThreads) {
  std::atomic<int> running{0}, most{0};
  WorkerPool pool(3);
  for (int i = 0; i < 60; ++i) {
    pool.Run([&] {
      const int now = ++running;
      for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      --running;
    });
  }
  pool.Shutdown();
  EXPECT_EQ(most, 3);
}

TEST(WorkerPool, TakesTasksOfManyCallers) {
  std::atomic<int> done{0};
  WorkerPool pool(8);
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&] {
      for (int k = 0; k < 2000; ++k) pool.Run([&done] { ++done; });
    });
  }
  for (std::thread& caller : callers) caller.join();
  pool.Shutdown();
  EXPECT_EQ(done, 16000);
}

}  // namespace
}  // namespace facetless
