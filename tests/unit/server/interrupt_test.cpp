#include "server/base/interrupt.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace facetless {
namespace {

void WaitFor(const std::atomic<bool>& flag) {
  while (!flag) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Deadline, ExpiresWhenItsTimeIsOver) {
  const Deadline deadline(0.001, nullptr);
  WaitFor(*deadline.flag());
  EXPECT_TRUE(deadline.expired());
}

TEST(Deadline, FollowsTheFlagThatItWatches) {
  std::atomic<bool> watched{false};
  const Deadline deadline(0, &watched);
  watched = true;
  WaitFor(*deadline.flag());
  EXPECT_FALSE(deadline.expired());
}

TEST(Deadline, BeginsWhenItIsStarted) {
  Deadline deadline(0, nullptr);
  EXPECT_FALSE(*deadline.flag());
  deadline.Start(0.001);
  WaitFor(*deadline.flag());
  EXPECT_TRUE(deadline.expired());
}

TEST(Deadline, IsOverWhenItIsSaidToBe) {
  Deadline deadline(0, nullptr);
  deadline.Expire();
  EXPECT_TRUE(*deadline.flag());
  EXPECT_TRUE(deadline.expired());
}

}  // namespace
}  // namespace facetless
