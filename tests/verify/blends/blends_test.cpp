// A fixed sample of the blends that facetless_blends tries: fillets, chamfers, sweeps, lofts and offsets from
// OpenCASCADE.
#include "tests/verify/blends/blends.h"

#include <OSD.hxx>

#include <gtest/gtest.h>

namespace facetless {
namespace {

class Blends : public ::testing::TestWithParam<int> {};

constexpr int kPerTest = 8;
// OpenCASCADE works on this offset for more than a minute before there is a shape to render. facetless_blends
// stops it, and lists it.
constexpr std::uint64_t kSlowSeed = 24;

TEST_P(Blends, AreRenderedWithoutALeakAndAsTheOracleSays) {
  OSD::SetSignal(false);
  int made = 0;
  for (int i = 0; i < kPerTest; ++i) {
    const std::uint64_t seed = static_cast<std::uint64_t>(GetParam() * kPerTest + i);
    if (seed == kSlowSeed) continue;
    const std::optional<Blend> blend = MakeBlend(seed);
    if (!blend) continue;
    ++made;
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + blend->what);
    const Result<Model> model = ModelOfBlend(*blend);
    ASSERT_TRUE(model.ok()) << model.error().message;
    const Result<BlendReport> report = JudgeBlend(model.value(), seed, 96);
    ASSERT_TRUE(report.ok()) << report.error().message;
    EXPECT_EQ(report.value().odd, 0u);
    EXPECT_EQ(report.value().mismatched, 0u);
    EXPECT_EQ(report.value().contradicted, 0u);
    EXPECT_EQ(report.value().wrong, 0u);
    EXPECT_EQ(report.value().limited, 0u);
    EXPECT_GT(report.value().certified, report.value().rays * 9 / 10);
  }
  EXPECT_GT(made, 0) << "OpenCASCADE made none of them";
}

INSTANTIATE_TEST_SUITE_P(Seeds, Blends, ::testing::Range(0, 8));

}  // namespace
}  // namespace facetless
