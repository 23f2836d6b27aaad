// Tests when an aim counts as met.
#include "bench/aims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <set>

#include "bench/plot.h"

namespace facetless {
namespace {

using testing::HasSubstr;

BenchValue Value(const char* aim, const char* file, double ratio, int threads = 1) {
  BenchValue value;
  value.aim = aim;
  value.file = file;
  value.view = "iso";
  value.threads = threads;
  value.direct = 10;
  value.other = 10 * ratio;
  value.ratio = ratio;
  return value;
}

const AimSummary& SummaryOf(const std::vector<AimSummary>& summaries, const std::string& aim) {
  for (const AimSummary& summary : summaries)
    if (summary.aim->id == aim) return summary;
  ADD_FAILURE() << "no summary of " << aim;
  return summaries.front();
}

TEST(Aims, HaveDistinctNames) {
  std::set<std::string> ids, numbers;
  for (const Aim& aim : Aims()) {
    EXPECT_TRUE(ids.insert(aim.id).second) << aim.id;
    EXPECT_TRUE(numbers.insert(aim.number).second) << aim.number;
    EXPECT_EQ(aim.IsComparisonAlone(), std::string(aim.text) == "none") << aim.id;
  }
  EXPECT_EQ(&FindAim("two_cores"), &FindAim("two_cores"));
}

TEST(Aims, AMeanThatIsHighEnoughDoesNotExcuseOneThatIsTooLow) {
  const auto met =
      Summarise({Value("first_image_default_mesh", "a", 8), Value("first_image_default_mesh", "b", 0.7)});
  EXPECT_NEAR(met.front().mean, std::sqrt(5.6), 1e-12);
  EXPECT_TRUE(met.front().met);
  const auto missed =
      Summarise({Value("first_image_default_mesh", "a", 100), Value("first_image_default_mesh", "b", 0.5)});
  EXPECT_FALSE(missed.front().met);
  EXPECT_EQ(missed.front().worst_file, "b");
}

TEST(Aims, UpperBoundsAreMetFromBelow) {
  EXPECT_TRUE(Summarise({Value("memory", "a", 0.1)}).front().met);
  const auto missed = Summarise({Value("memory", "a", 0.1), Value("memory", "b", 0.9)});
  EXPECT_FALSE(missed.front().met);
  EXPECT_EQ(missed.front().worst_file, "b") << "the worst of an upper bound is the largest";
}

TEST(Aims, AComparisonAloneIsNeitherMetNorMissed) {
  const std::vector<BenchValue> values = {Value("import", "a", 0.2)};
  EXPECT_TRUE(SummaryJson(Summarise(values).front()).at("met").is_null());
  EXPECT_EQ(AimTable(values).rows.front().back(), "-");
  EXPECT_TRUE(SummaryJson(Summarise({Value("memory", "a", 0.1)}).front()).at("met").get<bool>());
}

TEST(Aims, ANumberThatIsNoneMeetsNothing) {
  EXPECT_FALSE(Summarise({Value("memory", "a", NAN)}).front().met);
  EXPECT_FALSE(Summarise({Value("two_cores", "a", NAN)}).front().met);
}

TEST(Aims, ThreadsAreKeptApartAndSkippedValuesLeftOut) {
  BenchValue skipped = Value("memory", "a", 0);
  skipped.skipped = "meshing takes longer than 1 s";
  const std::vector<BenchValue> values = {Value("trace_fine_mesh", "a", 2, 1),
                                          Value("trace_fine_mesh", "a", 1, 4), skipped};
  const auto summaries = Summarise(values);
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_EQ(summaries[0].threads, 1);
  EXPECT_TRUE(summaries[0].met);
  EXPECT_EQ(summaries[1].threads, 4);
  EXPECT_FALSE(summaries[1].met);
  EXPECT_EQ(AimTable(values).rows.size(), 2u);
  const Table each = ValueTable(values);
  EXPECT_EQ(each.rows.size(), 3u);
  ASSERT_EQ(each.notes.size(), 1u);
  EXPECT_THAT(each.notes[0], HasSubstr("meshing takes longer than 1 s"));
  EXPECT_EQ(ValueJson(skipped).at("skipped"), "meshing takes longer than 1 s");
}

TEST(Aims, AValueAtTheLimitSaysSo) {
  BenchValue value = Value("first_image_fine_mesh", "slow & <heavy>.step", 60);
  value.at_limit = true;
  const Table table = ValueTable({value});
  EXPECT_EQ(table.rows[0][6], "> 60.0×");
  EXPECT_TRUE(ValueJson(value).at("at_limit").get<bool>());
  const std::string plot = FirstImagePlot({value}, 1);
  EXPECT_THAT(plot, HasSubstr("> 600 ms"));
  EXPECT_THAT(plot, HasSubstr("slow &amp; &lt;heavy>.step"));
  EXPECT_EQ(plot, FirstImagePlot({value}, 1));
  EXPECT_THAT(FirstImagePlot({}, 1), HasSubstr("No file was measured"));
}

TEST(Aims, SummariesAreJson) {
  const nlohmann::json json = SummaryJson(SummaryOf(Summarise({Value("next_view", "a", 0.4)}), "next_view"));
  EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
  EXPECT_TRUE(json.at("met").get<bool>());
  EXPECT_TRUE(json.at("aim").at("at_most").get<bool>());
  EXPECT_TRUE(json.at("aim").at("each").is_null());
}

}  // namespace
}  // namespace facetless
