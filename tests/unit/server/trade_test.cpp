// Tests `facetless trade` as a whole, on a sample: its files, and the consistency of its numbers.
#include "server/run/trade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "server/base/exit_code.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Json = nlohmann::json;

class Trade : public testing::Test {
 protected:
  ChildOutcome Run(std::vector<std::string> arguments, const std::string& file = Sample("sphere.step")) {
    arguments.insert(arguments.begin(), {"trade", file, "--out", out_});
    return RunProgram(Program("facetless"), arguments, directory_.path(), {"TMPDIR=" + scratch_.path()});
  }
  Json Report() const { return Json::parse(ReadText(out_ + "/report.json")); }
  Json PointOf(const Json& report, const std::string& name) const {
    for (const Json& point : report.at("trade").at("points"))
      if (point.at("name") == name) return point;
    ADD_FAILURE() << "no point is named " << name;
    return {};
  }

  TempDir directory_ = TempDir::Create().value(), scratch_ = TempDir::Create().value();
  std::string out_ = directory_.File("trade");
};

TEST_F(Trade, MeasuresBothTracersAndAnswers) {
  const ChildOutcome outcome = Run({"--deflections", "1e-2,1e-3", "--angles", "30", "--tolerances", "1e-3",
                                    "--size", "128x128", "--max-error-mm", "0.1"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  EXPECT_EQ(outcome.out, out_ + "/report.json\n");
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(out_)) files.insert(file.path().filename());
  EXPECT_EQ(files, (std::set<std::string>{"report.json", "report.html", "iso.direct.png", "trade-time.svg",
                                          "trade-time.png", "trade-memory.svg", "trade-memory.png"}));
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "temporary files were left behind";

  // Every point must be there, complete, and its times must add up.
  const Json report = Report();
  std::set<std::string> names;
  for (const Json& point : report.at("trade").at("points")) {
    names.insert(point.at("name"));
    ASSERT_TRUE(point.at("measured").get<bool>()) << point;
    const Json& ms = point.at("timing_ms");
    EXPECT_NEAR(ms.at("total"),
                ms.at("prepare").get<double>() + ms.at("trace").get<double>() + ms.at("shade").get<double>(),
                1e-9);
    EXPECT_GE(point.at("repetitions").get<int>(), 1);
    EXPECT_GE(point.at("peak_bytes"), point.at("tracer_peak_bytes"));
    for (const char* error : {"depth_mm", "deviation_mm"}) {
      EXPECT_LE(point.at(error).at("p95"), point.at(error).at("p99"));
      EXPECT_LE(point.at(error).at("p99"), point.at(error).at("max"));
    }
    EXPECT_TRUE(point.at("silhouette").contains("max_distance_px"));
    EXPECT_LE(point.at("flip").at("mean"), 1);
  }
  EXPECT_EQ(names, (std::set<std::string>{"fast", "standard, tolerance 1e-3", "standard", "certified",
                                          "mesh 1e-2, 30°", "mesh 1e-3, 30°"}));

  // The certified point is exact. A finer mesh is better, by as much as the deflection promises, which is
  // 1e-3 of the diagonal.
  EXPECT_EQ(PointOf(report, "certified").at("depth_mm").at("max"), 0);
  const Json coarse = PointOf(report, "mesh 1e-2, 30°"), fine = PointOf(report, "mesh 1e-3, 30°");
  EXPECT_LT(fine.at("deviation_mm").at("p99"), coarse.at("deviation_mm").at("p99"));
  EXPECT_GT(fine.at("triangles"), coarse.at("triangles"));
  EXPECT_LE(fine.at("deviation_mm").at("p99").get<double>(), 2 * fine.at("deflection_mm").get<double>());

  // Each front must contain points, the answers must name existing points, and all outputs must have the same
  // sentences.
  for (const char* front : {"time", "memory"}) {
    bool any = false;
    for (const Json& point : report.at("trade").at("points"))
      any = any || point.at("pareto").at(front).get<bool>();
    EXPECT_TRUE(any) << front;
  }
  const std::string page = ReadText(out_ + "/report.html");
  std::set<std::string> questions;
  for (const Json& answer : report.at("trade").at("answers")) {
    questions.insert(answer.at("question"));
    EXPECT_THAT(outcome.error_tail, HasSubstr(answer.at("sentence").get<std::string>()));
    EXPECT_THAT(page, HasSubstr(answer.at("sentence").get<std::string>()));
    const Json mesh = answer.value("mesh", Json());
    if (!mesh.is_null()) {
      EXPECT_THAT(names, Contains(mesh));
    }
  }
  EXPECT_THAT(questions, Contains("max_error_mm"));
  EXPECT_THAT(questions, Contains("direct_cheaper_time"));
  EXPECT_THAT(questions, Contains("direct_cheaper_memory"));
  EXPECT_THAT(page, HasSubstr("tradeSection")) << "the page draws its plots from the numbers";
}

TEST_F(Trade, GivesEachViewItsPlots) {
  const ChildOutcome outcome = Run(
      {"--deflections", "1e-2", "--tolerances", "1e-3", "--size", "48x48", "--view", "iso", "--view", "top"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  for (const char* file : {"iso.trade-time.svg", "top.trade-memory.png", "top.direct.png"})
    EXPECT_TRUE(std::filesystem::exists(out_ + "/" + file)) << file;
  EXPECT_EQ(Report().at("views").size(), 2u);
}

TEST_F(Trade, SkipsWhatExceedsItsBudgetAndSaysSo) {
  // The wavy sheet takes seconds at 1e-4. At 1e-5 it is no longer tried.
  const ChildOutcome outcome = Run({"--deflections", "3e-2,1e-4,1e-5", "--angles", "30", "--tolerances",
                                    "1e-3", "--size", "48x48", "--budget-seconds", "0.4"},
                                   Sample("wavy_sheet.step"));
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  const Json report = Report(), over = PointOf(report, "mesh 1e-4, 30°"),
             after = PointOf(report, "mesh 1e-5, 30°");
  EXPECT_FALSE(over.at("measured").get<bool>());
  EXPECT_EQ(over.at("skipped"), "meshing takes longer than 0.4 s (--budget-seconds)");
  EXPECT_EQ(after.at("skipped"), "not tried, since mesh 1e-4, 30° exceeded its budget");
  EXPECT_THAT(outcome.error_tail, HasSubstr("not measured: meshing takes longer"));
}

TEST_F(Trade, SaysInOneSentenceWhatIsWrong) {
  const ChildOutcome list = Run({"--deflections", "1e-2,fine"});
  EXPECT_EQ(list.exit_code, kExitUsage);
  EXPECT_EQ(list.error_tail, "facetless: deflections is \"fine\", but must be a number from 1e-09 to 1\n");
  const ChildOutcome broken = Run({}, Sample("broken/wrong_type.step"));
  EXPECT_EQ(broken.exit_code, kExitUnusable);
  EXPECT_EQ(std::count(broken.error_tail.begin(), broken.error_tail.end(), '\n'), 1) << broken.error_tail;
  const ChildOutcome late = Run({"--timeout", "0.01", "--size", "256x256"});
  EXPECT_EQ(late.exit_code, kExitUnusable);
  EXPECT_THAT(late.error_tail, HasSubstr("use --timeout to allow more"));
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

// The bolts of the assembly, which are placed eight times, are hidden.
TEST_F(Trade, MeasuresWhatIsShown) {
  std::string text = ReadText(Sample("assembly.step"));
  const std::size_t styled = text.find("STYLED_ITEM('color',(#1584),#765)");
  ASSERT_NE(styled, std::string::npos);
  text.insert(text.rfind("ENDSEC;"), "#99999 = INVISIBILITY((#1583));\n");
  const std::string file = WriteText(directory_.File("hidden.step"), text);
  const std::vector<std::string> usual = {"--deflections", "1e-2", "--angles", "30",
                                          "--tolerances",  "1e-3", "--size",   "96x96"};
  std::vector<std::string> all = usual;
  all.emplace_back("--show-hidden");
  ASSERT_EQ(Run(usual, file).exit_code, kExitDone);
  const Json shown = Report();
  ASSERT_EQ(Run(all, file).exit_code, kExitDone);
  const Json whole = Report();
  EXPECT_EQ(shown.at("arrangement").at("left_out").at("hidden_by_file"), 8);
  EXPECT_FALSE(whole.contains("arrangement"));
  EXPECT_LT(shown.at("views").at(0).at("reference").at("hits"),
            whole.at("views").at(0).at("reference").at("hits"));
  const Json mesh = PointOf(shown, "mesh 1e-2, 30°"), whole_mesh = PointOf(whole, "mesh 1e-2, 30°");
  EXPECT_LT(mesh.at("triangles"), whole_mesh.at("triangles"));
  EXPECT_LT(PointOf(shown, "certified").at("leaves"), PointOf(whole, "certified").at("leaves"));
  // Both tracers must see the same parts: a part that only one of them saw would give an error of
  // millimetres.
  EXPECT_LE(mesh.at("deviation_mm").at("p99").get<double>(), 2 * mesh.at("deflection_mm").get<double>());
}

}  // namespace
}  // namespace facetless
