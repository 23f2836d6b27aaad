// Tests which requests are the same question.
#include "server/service/jobs/submission.h"

#include <gtest/gtest.h>

#include "tests/unit/server/option_samples.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string QuestionOf(Json options, JobKind kind = JobKind::kComparison) {
  options["model"] = std::string(64, 'a');
  HttpRequest request;
  request.parts.push_back({});
  request.parts.back().text = options.dump();
  const auto submission = ParseSubmission(request, kind, std::uint64_t{1} << 40);
  EXPECT_TRUE(submission.ok()) << submission.error().message;
  return submission.ok() ? submission.value().question : "";
}

TEST(Submission, TheSameOptionsWrittenOtherwiseAreTheSameQuestion) {
  const std::string usual = QuestionOf(Json::object());
  EXPECT_EQ(QuestionOf({{"view", "iso"}, {"size", {1024, 1024}}, {"samples", 4}, {"deflection", 1e-3}}),
            usual);
  EXPECT_EQ(QuestionOf({{"shade", "studio"}, {"color", "face"}, {"audit", false}, {"explode", 0}}), usual);
  EXPECT_EQ(QuestionOf({{"deflection-mm", 1}}), QuestionOf({{"deflection_mm", 1.0}}));
  EXPECT_EQ(QuestionOf({{"size", "80x60"}}), QuestionOf({{"size", {80, 60}}}));
  EXPECT_EQ(QuestionOf({{"view", "iso,top"}}), QuestionOf({{"view", {"iso", "top"}}}));
  EXPECT_EQ(QuestionOf({{"unit", "in"}}), QuestionOf({{"unit", 25.4}}));
  EXPECT_EQ(QuestionOf({{"section", "z=12.5"}}), QuestionOf({{"section", {{0, 0, 12.5, 0, 0, 2}}}}));
  EXPECT_EQ(QuestionOf({{"shade", "zebra:stripes=7"}}),
            QuestionOf({{"shade", {{"name", "zebra"}, {"stripes", 7}}}}));
  EXPECT_EQ(QuestionOf({{"deflections", "1e-2,1e-3"}}, JobKind::kTrade),
            QuestionOf({{"deflections", {1e-2, 1e-3}}}, JobKind::kTrade));
}

TEST(Submission, EveryOptionOfRequestsMakesAnotherQuestion) {
  for (const JobKindRow& kind : JobKinds()) {
    if (kind.commands == 0) continue;
    const std::string usual = QuestionOf(Json::object(), kind.kind);
    for (const OptionRow& row : AllOptions()) {
      if (row.owner != OptionOwner::kCaller || (row.commands & kind.commands) == 0 ||
          row.name.starts_with("mesh_u"))  // these need a mesh
        continue;
      EXPECT_NE(QuestionOf({{row.name, AnotherValueOf(row)}}, kind.kind), usual)
          << kind.name << ", " << row.name;
    }
  }
}

TEST(Submission, OtherwiseTheQuestionIsAnother) {
  const std::string usual = QuestionOf(Json::object());
  EXPECT_NE(QuestionOf(Json::object(), JobKind::kRender), usual);
  EXPECT_NE(QuestionOf({{"color", "#102030"}}), QuestionOf({{"color", "#102031"}}));
  EXPECT_NE(QuestionOf({{"section", "z=50%"}}), QuestionOf({{"section", "z=50"}}));
  EXPECT_NE(QuestionOf({{"shade", "zebra:stripes=7"}}), QuestionOf({{"shade", "zebra:stripes=8"}}));
  // A budget that the request names is reduced less than the default budget.
  EXPECT_NE(QuestionOf({{"budget_seconds", 60}}, JobKind::kTrade),
            QuestionOf(Json::object(), JobKind::kTrade));
}

}  // namespace
}  // namespace facetless
