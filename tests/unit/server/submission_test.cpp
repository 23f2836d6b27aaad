// Which requests are the same question.
#include "server/service/jobs/submission.h"

#include <gtest/gtest.h>

namespace facetless {
namespace {

using Json = nlohmann::json;

std::string QuestionOf(Json options, const std::string& kind = "comparison") {
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
  EXPECT_EQ(QuestionOf({{"shade", "studio"}, {"color", "face"}, {"audit", false}, {"turntable", 0}}), usual);
  EXPECT_EQ(QuestionOf({{"deflection-mm", 1}}), QuestionOf({{"deflection_mm", 1.0}}));
  EXPECT_EQ(QuestionOf({{"size", "80x60"}}), QuestionOf({{"size", {80, 60}}}));
  EXPECT_EQ(QuestionOf({{"view", "iso,top"}}), QuestionOf({{"view", {"iso", "top"}}}));
  EXPECT_EQ(QuestionOf({{"unit", "in"}}), QuestionOf({{"unit", 25.4}}));
  EXPECT_EQ(QuestionOf({{"section", "z=12.5"}}), QuestionOf({{"section", {{0, 0, 12.5, 0, 0, 2}}}}));
  EXPECT_EQ(QuestionOf({{"shade", "zebra:stripes=7"}}),
            QuestionOf({{"shade", {{"name", "zebra"}, {"stripes", 7}}}}));
  EXPECT_EQ(QuestionOf({{"deflections", "1e-2,1e-3"}}, "trade"),
            QuestionOf({{"deflections", {1e-2, 1e-3}}}, "trade"));
}

TEST(Submission, EveryOptionOfRequestsMakesAnotherQuestion) {
  const std::string usual = QuestionOf(Json::object(), "render");
  for (const OptionRow& row : AllOptions()) {
    if (row.owner != OptionOwner::kCaller || row.name.starts_with("mesh_u")) continue;  // these need a mesh
    Json other;
    if (row.kind == OptionKind::kFlag) other = true;
    if (row.kind == OptionKind::kChoice) other = row.choices[row.choices.front() == row.usual ? 1 : 0];
    if (row.kind == OptionKind::kNumber || row.kind == OptionKind::kInteger)
      other = std::isinf(row.high) ? 12345.0 : row.high;
    if (row.kind == OptionKind::kNumbers) other = Json::array({row.high});
    for (const auto& [name, value] : {std::pair<const char*, Json>{"view", "top"},
                                      {"camera", {{"eye", {1, 2, 3}}}},
                                      {"size", "80x60"},
                                      {"section", "x=1"},
                                      {"shade", "zebra"},
                                      {"aov", "uv"},
                                      {"with", "fast"},
                                      {"color", "part"},
                                      {"parts", "a"},
                                      {"hide", "a"},
                                      {"unit", "cm"}})
      if (row.name == name) other = value;
    ASSERT_FALSE(other.is_null()) << row.name;
    EXPECT_NE(QuestionOf({{row.name, other}}, "render"), usual) << row.name;
  }
}

TEST(Submission, OtherwiseTheQuestionIsAnother) {
  const std::string usual = QuestionOf(Json::object());
  EXPECT_NE(QuestionOf(Json::object(), "render"), usual);
  EXPECT_NE(QuestionOf({{"color", "#102030"}}), QuestionOf({{"color", "#102031"}}));
  EXPECT_NE(QuestionOf({{"section", "z=50%"}}), QuestionOf({{"section", "z=50"}}));
  EXPECT_NE(QuestionOf({{"shade", "zebra:stripes=7"}}), QuestionOf({{"shade", "zebra:stripes=8"}}));
  // A budget that is named is cut less than one that is not.
  EXPECT_NE(QuestionOf({{"budget_seconds", 60}}, "trade"), QuestionOf(Json::object(), "trade"));
}

}  // namespace
}  // namespace facetless
