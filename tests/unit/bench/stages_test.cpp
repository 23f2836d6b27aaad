// Tests how the times of a report become the stages of a run.
#include "bench/stages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

// A comparison of two views whose times are small integers.
Json Report() {
  const Json direct = {{"prepare", 5}, {"trace", 6}, {"color", 7}, {"lines", 0}, {"shade", 8}, {"total", 26}};
  const Json mesh = {{"mesh", 4}, {"build", 1}, {"trace", 2}, {"color", 3}, {"shade", 4}, {"total", 10}};
  const Json view = {{"direct", {{"timing_ms", direct}}},
                     {"baseline", {{"timing_ms", mesh}}},
                     {"timing_ms", {{"difference", 9}, {"files", 10}}}};
  return {{"command", "compare"},
          {"timing_ms",
           {{"import", 30},
            {"import_read", 10},
            {"import_transfer", 8},
            {"import_convert", 5},
            {"load", 2},
            {"scene", 1},
            {"total", 200}}},
          {"views", {view, view}}};
}

double TimeOf(const ProgramStages& run, const std::string& name) {
  for (const Stage& stage : run.stages)
    if (stage.name == name) return stage.ms;
  ADD_FAILURE() << "there is no stage " << name;
  return -1;
}

double SumOf(const ProgramStages& run) {
  double sum = 0;
  for (const Stage& stage : run.stages) sum += stage.ms;
  return sum;
}

TEST(Stages, MakeUpTheWholeTime) {
  const ProgramStages run = StagesOf(Report(), {.wall_ms = 250, .start_ms = 20});
  EXPECT_EQ(run.command, "compare");
  EXPECT_EQ(TimeOf(run, "start"), 20);
  EXPECT_EQ(TimeOf(run, "import_mesh"), 4) << "the mesh is made once for all views";
  EXPECT_EQ(TimeOf(run, "import_process"), 30 - 10 - 8 - 5 - 4);
  EXPECT_EQ(TimeOf(run, "direct_trace"), 12) << "the times of views are added";
  EXPECT_EQ(TimeOf(run, "mesh_build"), 2);
  EXPECT_EQ(TimeOf(run, "difference"), 18);
  EXPECT_EQ(TimeOf(run, "other"), 200 - 30 - 2 - 1 - 2 * (26 + 10 + 9 + 10));
  EXPECT_EQ(TimeOf(run, "report"), 250 - 20 - 200);
  EXPECT_DOUBLE_EQ(SumOf(run), 250);
  EXPECT_EQ(run.overlap_ms, 0);
}

TEST(Stages, ThatRanBesideEachOtherOverlap) {
  Json report = Report();
  report["timing_ms"]["total"] = 100;
  const ProgramStages run = StagesOf(report, {.wall_ms = 150, .start_ms = 20});
  EXPECT_EQ(TimeOf(run, "other"), 0);
  EXPECT_DOUBLE_EQ(run.overlap_ms, 33 + 110 - 100);
  EXPECT_DOUBLE_EQ(SumOf(run) - run.overlap_ms, run.wall_ms);
}

TEST(Stages, OfARenderHaveNoMesh) {
  Json report = Report();
  report["command"] = "render";
  for (Json& view : report["views"]) view.erase("baseline");
  const ProgramStages run = StagesOf(report, {.wall_ms = 250, .start_ms = 20});
  for (const char* name : {"import_mesh", "mesh_build", "mesh_trace", "mesh_color", "mesh_shade"})
    EXPECT_EQ(TimeOf(run, name), 0) << name;
  EXPECT_DOUBLE_EQ(SumOf(run), 250);
}

TEST(Stages, TheMedianRunCounts) {
  std::vector<ProgramStages> runs(3);
  runs[0].wall_ms = 30;
  runs[1].wall_ms = 10;
  runs[2].wall_ms = 20;
  EXPECT_EQ(MedianRun(runs).wall_ms, 20);
}

TEST(Stages, AreShownInTablesAndAPlot) {
  ProgramStages compare = StagesOf(Report(), {.wall_ms = 250, .start_ms = 20});
  compare.file = "a<b.step";
  ProgramStages render = compare;
  render.command = "render";
  const std::vector<Table> tables = StageTables({render, compare});
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].columns, (std::vector<std::string>{"stage", "render", "compare"}));
  for (const auto& row : tables[0].rows) {
    EXPECT_EQ(row.size(), 3u);
    EXPECT_NE(row[0], "exact: lines") << "no run has this stage";
  }
  EXPECT_EQ(tables[0].rows.back()[0], "whole");

  const std::string plot = StagePlot({render, compare});
  EXPECT_THAT(plot, HasSubstr("compare a&lt;b.step: 250 ms"));
  EXPECT_THAT(plot, HasSubstr("exact: tracing"));
  EXPECT_THAT(plot, Not(HasSubstr("exact: lines")));
  EXPECT_EQ(plot, StagePlot({render, compare}));
  EXPECT_THAT(StagePlot({}), HasSubstr("No run was measured"));
}

TEST(Stages, AreWrittenAsJson) {
  const Json json = StagesJson(StagesOf(Report(), {.wall_ms = 250, .start_ms = 20}));
  EXPECT_EQ(Json::parse(json.dump()), json);
  double sum = 0;
  for (const Json& stage : json.at("stages")) sum += stage.at("ms").get<double>();
  EXPECT_DOUBLE_EQ(sum - json.at("overlap_ms").get<double>(), json.at("wall_ms").get<double>());
}

}  // namespace
}  // namespace facetless
