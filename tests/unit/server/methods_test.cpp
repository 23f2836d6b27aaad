// A representation that the program does not know (tests/support/box_method: one file with one line of
// registration) must appear in the same places as the others: in compare, in trade, in the report and in
// report.html.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "server/base/exit_code.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsSubsetOf;
using testing::Not;
using Json = nlohmann::json;

class WithBox : public testing::Test {
 protected:
  ChildOutcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--out", out_});
    return RunProgram(Program("facetless-with-box"), arguments, directory_.path(), {"TMPDIR=/tmp"});
  }
  Json Report() const { return Json::parse(ReadText(out_ + "/report.json")); }

  TempDir directory_ = TempDir::Create().value();
  std::string out_ = directory_.File("out");
};

TEST_F(WithBox, CompareShowsEveryCandidate) {
  const ChildOutcome outcome = Run({"compare", Sample("sphere.step"), "--with", "box:100,fast", "--size",
                                    "64x64", "--view", "front", "--sheet"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  const Json view = Report().at("views").at(0);
  // The roles of the baseline must not have changed.
  EXPECT_TRUE(view.contains("baseline") && view.contains("difference"));
  ASSERT_EQ(view.at("candidates").size(), 2u);
  const Json &box = view.at("candidates").at(0), &fast = view.at("candidates").at(1);
  EXPECT_EQ(box.at("name"), "box-100");
  EXPECT_EQ(box.at("title"), "Box 100");
  EXPECT_EQ(box.at("facts").at("boxes"), 1);
  EXPECT_EQ(fast.at("name"), "fast");
  // The front of a sphere's box is a square that touches the sphere in one point. Everywhere else it is
  // nearer to the eye, by up to the radius at the outline.
  const double radius = Report().at("model").at("bounds_mm").at(1).at(0).get<double>() / 2 -
                        Report().at("model").at("bounds_mm").at(0).at(0).get<double>() / 2;
  const Json& depth = box.at("difference").at("depth_mm");
  EXPECT_LT(depth.at("mean").get<double>(), -0.3 * radius);
  EXPECT_GT(depth.at("mean").get<double>(), -0.36 * radius)
      << "the mean over a disc must be a third of the radius";
  EXPECT_GT(box.at("hits").get<int>(), view.at("direct").at("hits").get<int>());
  EXPECT_LT(fast.at("difference").at("deviation_mm").at("max").get<double>(), 1e-4 * radius);
  // There must be files of each candidate, and report.html must contain each.
  std::map<std::string, std::string> files = view.at("files");
  for (const char* role :
       {"direct", "baseline", "difference", "box-100", "box-100-difference", "box-100-depth",
        "box-100-pixel-deviation", "fast", "fast-difference", "fast-pixel-status"}) {
    ASSERT_TRUE(files.contains(role)) << role;
    EXPECT_TRUE(std::filesystem::exists(out_ + "/" + files.at(role))) << role;
  }
  EXPECT_FALSE(files.contains("box-100-pixel-faces")) << "the direct faces are the same for all";
  const std::string page = ReadText(out_ + "/report.html");
  for (const char* name : {"front.box-100.png", "front.fast-pixel-deviation.png"})
    EXPECT_THAT(page, HasSubstr(name));
}

TEST_F(WithBox, AComparisonWithoutMethodsHasNoCandidates) {
  ASSERT_EQ(Run({"compare", Sample("sphere.step"), "--size", "32x32"}).exit_code, kExitDone);
  EXPECT_FALSE(Report().at("views").at(0).contains("candidates"));
}

TEST_F(WithBox, TradeMeasuresEverySetting) {
  const ChildOutcome outcome =
      Run({"trade", Sample("sphere.step"), "--with", "box,fast", "--size", "64x64", "--deflections", "1e-2",
           "--angles", "30", "--tolerances", "1e-3", "--max-error-mm", "1e3"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  std::map<std::string, Json> points;
  const Json report = Report();
  for (const Json& point : report.at("trade").at("points")) points[point.at("name")] = point;
  for (const char* name : {"Box 50", "Box 100", "Single precision", "mesh 1e-2, 30°", "certified"}) {
    ASSERT_TRUE(points.contains(name)) << name;
    EXPECT_TRUE(points.at(name).at("measured").get<bool>()) << points.at(name);
  }
  EXPECT_EQ(points.at("Box 50").at("tracer"), "box");
  EXPECT_EQ(points.at("Box 50").at("setting"), 50);
  EXPECT_GT(points.at("Box 100").at("deviation_mm").at("p99").get<double>(),
            points.at("mesh 1e-2, 30°").at("deviation_mm").at("p99").get<double>());
  // The method must appear in the table, in the answer to the limit that it meets, and in the page.
  EXPECT_THAT(outcome.error_tail, HasSubstr("Box 100"));
  EXPECT_THAT(outcome.error_tail, testing::ContainsRegex("Box (50|100) keeps it for"));
  EXPECT_THAT(ReadText(out_ + "/report.html"), HasSubstr("Box 100"));
}

TEST_F(WithBox, WhatCannotBeMadeIsSaid) {
  EXPECT_THAT(Run({"--help"}).out, Not(HasSubstr("box:")));
  EXPECT_THAT(Run({"compare", "--help"}).out, HasSubstr("bezier-clipping, box:NUMBER, certified,"));
  for (const auto& [with, sentence] :
       {std::pair{"voxel", "there is no method 'voxel'; there are: bezier-clipping, box:NUMBER, certified,"},
        {"fast:2", "the method 'fast' takes no number; write 'fast' instead of 'fast:2'"},
        {"box:", "'box:' names no number of size, per cent; write for example 'box:50'"},
        {"box:50,box:5e1", "with lists \"box:50\" twice"},
        {"box:120", "--with box:120: a box has a size of more than 0 and up to 100 per cent"}}) {
    const ChildOutcome outcome = Run({"compare", Sample("sphere.step"), "--with", with, "--size", "32x32"});
    EXPECT_EQ(outcome.exit_code, kExitUsage) << with;
    EXPECT_THAT(outcome.error_tail, HasSubstr(sentence));
  }
}

}  // namespace
}  // namespace facetless
