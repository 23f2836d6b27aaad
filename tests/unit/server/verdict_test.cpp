// The verdict on a run, and the sentences that explain it.
#include "server/run/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/base/exit_code.h"

namespace facetless {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Verdict, FollowsLossesAndThresholds) {
  const std::vector<ViewValues> values = {{"iso", 0.1, 0.2, 3, 0.01, 0.5}};
  RunOptions options;
  EXPECT_EQ(Judge(options, values).exit_code, kExitDone);
  EXPECT_EQ(Judge(options, values, {.problems = {}, .lost = 2}).exit_code, kExitLost);
  EXPECT_TRUE(Judge(options, values, {.problems = {}, .lost = 2}).passed);
  EXPECT_EQ(Judge(options, values, {.problems = {}, .unmeshed = 1}).exit_code, kExitLost);
  options.fail.deviation_mm = 0.1;
  EXPECT_EQ(Judge(options, values).exit_code, kExitDone) << "the limit itself passes";
  options.fail.silhouette_px = 2;
  const Verdict verdict = Judge(options, values);
  EXPECT_EQ(verdict.exit_code, kExitFailed);
  ASSERT_EQ(verdict.broken.size(), 1u);
  EXPECT_EQ(verdict.broken[0].threshold, "fail_silhouette_px");
  EXPECT_EQ(verdict.broken[0].value, 3.0);
}

TEST(Verdict, IsFailedByWhatIsNoNumber) {
  RunOptions options;
  options.fail.flip = 1;
  options.fail.silhouette_px = 1e9;
  const Verdict verdict = Judge(options, {{"iso", 0, 0, INFINITY, NAN, 0}});
  ASSERT_EQ(verdict.broken.size(), 2u);
  EXPECT_TRUE(VerdictJson(verdict)["broken"][0]["value"].is_null());
}

TEST(Verdict, WithoutABaselineHasNotPassedAndHasACodeOfItsOwn) {
  const Verdict verdict = Judge({}, {}, {.problems = {}, .lost = 2, .no_baseline = "there is no mesh"});
  EXPECT_FALSE(verdict.passed);
  EXPECT_EQ(verdict.exit_code, kExitNoBaseline);
  EXPECT_EQ(VerdictSentences(verdict), (std::vector<std::string>{"there is no mesh"}));
  EXPECT_EQ(Judge({}, {}, {.problems = {"a defect"}, .no_baseline = "there is no mesh"}).exit_code,
            kExitFailed);
}

TEST(Verdict, StrictFailsWhatIsIncompleteOrGuessed) {
  RunOptions strict;
  strict.strict = true;
  EXPECT_EQ(Judge(strict, {}).exit_code, kExitDone);
  EXPECT_EQ(Judge(strict, {}, {.problems = {}, .lost = 1}).exit_code, kExitFailed);
  EXPECT_EQ(Judge(strict, {}, {.problems = {}, .unmeshed = 1}).exit_code, kExitFailed);
  EXPECT_EQ(Judge(strict, {}, {.problems = {}, .unit_known = false}).exit_code, kExitFailed);
  EXPECT_EQ(Judge({}, {}, {.problems = {}, .unit_known = false}).exit_code, kExitDone);
}

TEST(Verdict, SaysWhatBrokeByTheNameOfItsOption) {
  RunOptions options;
  options.strict = true;
  options.fail.depth_mm = 0.25;
  options.fail.flip = 0.5;
  const Findings findings = {
      .problems = {"the mesh is turned inside out"}, .lost = 3, .unmeshed = 2, .unit_known = false};
  EXPECT_THAT(
      VerdictSentences(Judge(options, {{"front", 0, 0.5, 0, INFINITY, 0}}, findings)),
      ElementsAre(HasSubstr("view 'front' breaks --fail-depth-mm: the value is 0.5, the limit is 0.25"),
                  HasSubstr("--fail-flip: the value is infinite"), "the mesh is turned inside out",
                  HasSubstr("lost 3"), HasSubstr("lacks 2 faces"), HasSubstr("--unit")));
  EXPECT_THAT(VerdictSentences(Judge({}, {{"front", 0, 0.5, 0, 0, 0}}, {.problems = {}, .lost = 3})),
              IsEmpty());
}

}  // namespace
}  // namespace facetless
