// Methods by name, from the outside: the list, the table on a file, pictures with marked errors, --method on render,
// compare and trade, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "render/compare/method.h"
#include "render/solve/solver.h"
#include "server/base/exit_code.h"
#include "server/base/web_assets.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::json;

class MethodOptions : public testing::Test {
 protected:
  ChildOutcome Run(const std::vector<std::string>& arguments) {
    return RunProgram(Program("facetless"), arguments, directory_.path(), {"TMPDIR=/tmp"});
  }
  ChildOutcome RunTo(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", out_});
    return Run(arguments);
  }
  Json Report(const char* file = "report.json") const { return Json::parse(ReadText(out_ + "/" + file)); }

  TempDir directory_ = TempDir::Create().value();
  std::string out_ = directory_.File("out");
};

TEST_F(MethodOptions, TheListHasSourcesAndPromises) {
  const ChildOutcome outcome = Run({"methods"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  for (const Method* method : Methods()) {
    EXPECT_THAT(outcome.out, HasSubstr(method->name + "  (" + method->title + ")"));
    EXPECT_FALSE(method->source.empty() || method->does_not.empty() || method->help.empty()) << method->name;
  }
  EXPECT_GE(Solvers().size(), 7u);
}

TEST_F(MethodOptions, ATableOnAFileAndPicturesOfTheErrors) {
  const ChildOutcome outcome = RunTo(
      {"methods", Sample("sphere.step"), "--size", "64x64", "--methods", "certified,newton-cramer,martin"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  for (const char* name :
       {"certified", "newton-cramer, published-map", "newton-cramer, map", "newton-cramer, pieces", "martin"})
    EXPECT_THAT(outcome.out, HasSubstr(std::string("\n") + name));
  const Json view = Report("methods.json").at("views").at(0);
  ASSERT_EQ(view.at("methods").size(), 5u);
  for (const Json& method : view.at("methods")) {
    SCOPED_TRACE(method.dump());
    EXPECT_EQ(method.at("rays"), 64 * 64);
    const bool map = method.at("starts") != nullptr && method.at("starts") != "pieces";
    EXPECT_EQ(method.at("no_start").is_null(), !map);
    if (method.at("method") == "certified") continue;
    EXPECT_TRUE(std::filesystem::exists(out_ + "/" + method.at("file").get<std::string>()));
    // The sphere is smooth: what is lost lies along its outline, where a map has no start.
    const Json& errors = method.at("errors");
    EXPECT_LE(errors.at("lost").get<int>() + errors.at("imprecise").get<int>(), map ? 60 : 2);
    EXPECT_EQ(errors.at("unresolved"), 0);
  }
  EXPECT_TRUE(std::filesystem::exists(out_ + "/iso.certified.png"));
}

TEST_F(MethodOptions, RenderSaysWhichMethodTraced) {
  const ChildOutcome outcome = RunTo(
      {"render", Sample("torus.step"), "--size", "64x64", "--method", "martin", "--structure", "octree"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  const Json report = Report();
  EXPECT_EQ(report.at("options").at("method"), "martin");
  const Json direct = report.at("views").at(0).at("direct");
  EXPECT_EQ(direct.at("method").at("name"), "martin");
  EXPECT_EQ(direct.at("method").at("structure"), "octree");
  EXPECT_GT(direct.at("method").at("stops").at("root").get<int>(), 100);
  EXPECT_EQ(direct.at("certified"), 0);
  EXPECT_EQ(direct.at("converged"), 64 * 64);
  EXPECT_GT(direct.at("iterations").get<int>(), 100);
}

TEST_F(MethodOptions, AComparisonShowsMethodsOnEitherSide) {
  const ChildOutcome outcome =
      RunTo({"compare", Sample("torus.step"), "--size", "64x64", "--method", "robust-clipping", "--with",
             "certified,newton-cramer", "--starts", "map"});
  // The method of the exact side does not start at a map.
  EXPECT_EQ(outcome.exit_code, kExitUsage);
  EXPECT_THAT(outcome.error_tail, HasSubstr("robust-clipping does not start at a map"));
  const ChildOutcome compared = RunTo({"compare", Sample("torus.step"), "--size", "64x64", "--method",
                                       "robust-clipping", "--with", "certified,newton-cramer"});
  ASSERT_EQ(compared.exit_code, kExitDone) << compared.error_tail;
  const Json view = Report().at("views").at(0);
  EXPECT_EQ(view.at("direct").at("method").at("name"), "robust-clipping");
  ASSERT_EQ(view.at("candidates").size(), 2u);
  EXPECT_EQ(view.at("candidates").at(0).at("name"), "certified");
  EXPECT_LT(view.at("candidates").at(0).at("difference").at("deviation_mm").at("max").get<double>(), 1e-6);
  EXPECT_EQ(view.at("candidates").at(1).at("method").at("starts"), "map");
}

TEST_F(MethodOptions, TradeMeasuresThem) {
  const ChildOutcome outcome =
      RunTo({"trade", Sample("sphere.step"), "--size", "64x64", "--deflections", "1e-2", "--angles", "30",
             "--tolerances", "1e-5", "--methods", "martin,newton-cramer"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  const Json trade = Report().at("trade");
  for (const char* title : {"Martin", "Newton–Cramer"}) {
    bool said = false;
    for (const Json& answer : trade.at("answers"))
      said = said || (answer.at("question") == "method" &&
                      answer.at("sentence").get<std::string>().find(title) != std::string::npos);
    EXPECT_TRUE(said) << title;
  }
}

TEST_F(MethodOptions, WhatAMethodCannotDoIsRefused) {
  const std::string file = Sample("sphere.step");
  for (const auto& [arguments, reason] : std::vector<std::pair<std::vector<std::string>, const char*>>{
           {{"render", file, "--method", "martin", "--section", "z=50%"}, "cannot cut a model"},
           {{"render", file, "--method", "martin", "--audit"}, "cannot count the crossings"},
           {{"render", file, "--method", "martin", "--precision", "certified"}, "proves nothing"},
           {{"render", file, "--method", "martin", "--starts", "map"}, "does not start at a map"},
           {{"render", file, "--starts", "map"}, "starts applies to methods that iterate"},
           {{"compare", file, "--starts", "map", "--with", "fast"}, "starts applies to methods that iterate"},
           {{"trade", file, "--starts", "map", "--methods", "fast"},
            "starts applies to methods that iterate"},
           {{"render", file, "--method", "newton"}, "newton-cramer"}}) {
    const ChildOutcome outcome = RunTo(arguments);
    EXPECT_EQ(outcome.exit_code, kExitUsage) << reason;
    EXPECT_THAT(outcome.error_tail, HasSubstr(reason));
  }
  const ChildOutcome nothing = RunTo({"methods"});
  EXPECT_EQ(nothing.exit_code, kExitUsage);
  EXPECT_THAT(nothing.error_tail, HasSubstr("--out needs a FILE"));
}

TEST(MethodOptionsOfThePage, AreTheMethods) {
  const std::string page(WebAsset("index.html"));
  for (const Method* method : Methods())
    if (method->setting.empty()) {
      EXPECT_THAT(page, HasSubstr("<option value=\"" + method->name + "\"")) << method->name;
    }
}

}  // namespace
}  // namespace facetless
