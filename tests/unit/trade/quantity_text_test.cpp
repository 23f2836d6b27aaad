#include "render/trade/quantity_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace facetless {
namespace {

TEST(QuantityText, HasTwoSignificantDigits) {
  EXPECT_EQ(NumberText(0), "0");
  EXPECT_EQ(NumberText(0.03149), "0.031");
  EXPECT_EQ(NumberText(1234), "1200");
  EXPECT_EQ(NumberText(4e-5), "4e-5");
  EXPECT_EQ(NumberText(0.000123), "1.2e-4");
  EXPECT_EQ(NumberText(-2.5e-12), "-2.5e-12");
  EXPECT_EQ(NumberText(3.5e7), "3.5e7");
  EXPECT_EQ(NumberText(NAN), "infinitely many");
}

TEST(QuantityText, TakesTheUnitThatFits) {
  EXPECT_EQ(TimeText(0.5), "0.5 ms");
  EXPECT_EQ(TimeText(340.2), "340 ms");
  EXPECT_EQ(TimeText(996), "1 s") << "and not 1000 ms";
  EXPECT_EQ(TimeText(62'000), "62 s");
  EXPECT_EQ(MemoryText(56.1e6), "56 MB");
  EXPECT_EQ(MemoryText(1.25e9), "1.2 GB");
  EXPECT_EQ(MillimetresText(0.5), "0.5 mm");
}

}  // namespace
}  // namespace facetless
