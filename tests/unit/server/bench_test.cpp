// Tests `facetless bench` as a whole, on a sample. No test depends on how fast anything is.
#include "server/run/bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "server/base/exit_code.h"
#include "server/importer/openvdb_process.h"
#include "server/run/bench_openvdb.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::json;

class BenchProgram : public testing::Test {
 protected:
  ChildOutcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "bench");
    return RunProgram(Program("facetless"), arguments, directory_.path(), {"TMPDIR=" + scratch_.path()});
  }

  TempDir directory_ = TempDir::Create().value(), scratch_ = TempDir::Create().value();
  std::string json_ = directory_.File("bench.json"), plot_ = directory_.File("bench.svg"),
              stage_plot_ = directory_.File("stages.svg");
};

// Both commands run from start to end, and their stages make up the whole time.
void CheckStages(const Json& report) {
  std::vector<std::string> commands;
  for (const Json& run : report.at("stages")) {
    commands.push_back(run.at("command"));
    EXPECT_EQ(run.at("file"), "bracket.step");
    std::map<std::string, double> ms;
    double sum = -run.at("overlap_ms").get<double>();
    for (const Json& stage : run.at("stages")) sum += ms[stage.at("name")] = stage.at("ms");
    EXPECT_NEAR(sum, run.at("wall_ms"), 1e-6);
    for (const char* name : {"start", "import_read", "import_transfer", "import_convert", "load",
                             "direct_prepare", "direct_trace", "direct_shade", "files"})
      EXPECT_GT(ms.at(name), 0) << name;
    EXPECT_EQ(ms.at("mesh_trace") > 0, commands.back() == "compare");
  }
  EXPECT_EQ(commands, (std::vector<std::string>{"render", "compare"}));
}

// Both sides have the same voxels but near the surface, where the mesh is not the solid, and their rays find the same ones.
TEST(OpenVdbBench, ComparesVoxelsAndRays) {
  if (!HasOpenVdb()) GTEST_SKIP() << "this build has no OpenVDB";
  const auto bench = MeasureOpenVdb(Sample("torus.step"), {}, {}, 1, {}, 64);
  ASSERT_TRUE(bench) << bench.error().message;
  const Json& json = bench.value().json;
  const auto inside = json.at("ours").at("inside").get<std::uint64_t>();
  EXPECT_EQ(json.at("ours").at("not_certified"), 0);
  EXPECT_GT(inside, 10000u);
  const auto differ = json.at("only_ours").get<std::uint64_t>() + json.at("only_theirs").get<std::uint64_t>();
  EXPECT_GT(differ, 0u) << "triangles are not a torus";
  EXPECT_LT(differ, inside / 50);
  EXPECT_EQ(json.at("at_least_wrong"), differ);
  EXPECT_EQ(json.at("rays_that_differ"), 0);
  EXPECT_GT(json.at("openvdb").at("volume").at("hits"), 10000);
  for (const Json& band : json.at("openvdb").at("bands"))
    EXPECT_EQ(band.at("inside").get<std::uint64_t>(), inside - json.at("only_ours").get<std::uint64_t>() +
                                                          json.at("only_theirs").get<std::uint64_t>());
  EXPECT_EQ(bench.value().tables.size(), 2u);
}

TEST_F(BenchProgram, MeasuresAFileAgainstTheAims) {
  const ChildOutcome outcome =
      Run({Sample("bracket.step"), "--size", "96x64", "--repeats", "1", "--threads", "2", "--no-growth",
           "--json", json_, "--plot", plot_, "--stage-plot", stage_plot_, "--markdown"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  EXPECT_THAT(outcome.out, HasSubstr("### Aims\n\n| row | what |"));
  for (const char* title :
       {"# Performance: files", "### Each file", "### Where the time goes", "### What was counted",
        "### Samples per pixel", "### From start to end: bracket.step"})
    EXPECT_THAT(outcome.out, HasSubstr(title));
  EXPECT_THAT(ReadText(plot_), StartsWith("<svg"));
  EXPECT_THAT(ReadText(plot_), HasSubstr("bracket.step iso"));
  EXPECT_THAT(ReadText(stage_plot_), HasSubstr("compare bracket.step"));
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "temporary files were left behind";

  const Json report = Json::parse(ReadText(json_));
  std::set<std::string> rows;
  for (const Json& row : report.at("rows")) {
    rows.insert(row.at("row"));
    EXPECT_EQ(row.at("met").is_null(), row.at("aim").at("text") == "none");
    EXPECT_THAT(outcome.out, HasSubstr(row.at("what").get<std::string>()));
  }
  EXPECT_THAT(
      rows, testing::IsSupersetOf({"first_image_default_mesh", "first_image_fine_mesh", "trace_fine_mesh",
                                   "trace_default_mesh", "trace_default_mesh_fast", "trace_fine_mesh_raw",
                                   "trace_default_mesh_raw", "trace_exact_intersector", "next_view", "memory",
                                   "import", "import_unhealed", "samples"}));
  const Json& view = report.at("files").at(0).at("views").at(0);
  // OpenCASCADE's intersector, the mesh and the direct renderer must agree on the part.
  const Json& exact = view.at("exact_intersector");
  EXPECT_GT(exact.at("rays"), 1000);
  EXPECT_GE(exact.at("same").get<double>(), 0.999 * exact.at("rays").get<double>());
  const Json& one = view.at("threads").at("1");
  const double hits = one.at("counters").at("hits");
  EXPECT_NEAR(one.at("mesh_1e-5").at("hits"), hits, 0.01 * hits);
  EXPECT_GT(one.at("mesh_1e-5").at("triangles"), one.at("mesh_1e-3").at("triangles"));
  for (const char* counter :
       {"candidates", "solves", "iterations", "fallbacks", "trim_tests", "useful_solves"})
    EXPECT_TRUE(one.at("counters").contains(counter)) << counter;
  EXPECT_TRUE(view.at("threads").contains("2"));
  CheckStages(report);
}

TEST_F(BenchProgram, AMeshThatTakesTooLongCountsAtTheLimit) {
  const ChildOutcome outcome =
      Run({Sample("wavy_sheet.step"), "--size", "48x48", "--repeats", "1", "--threads", "1", "--time-limit",
           "0.5", "--no-growth", "--no-stages", "--json", json_});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  EXPECT_THAT(outcome.out, HasSubstr("meshing takes longer than 0.5 s"));
  const Json answer = Json::parse(ReadText(json_));
  for (const Json& value : answer.at("values")) {
    if (value.at("row") != "first_image_fine_mesh") continue;
    EXPECT_TRUE(value.at("at_limit").get<bool>());
    EXPECT_EQ(value.at("other"), 500);
  }
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_F(BenchProgram, SaysInOneSentenceWhatIsWrong) {
  const ChildOutcome nothing = Run({});
  EXPECT_EQ(nothing.exit_code, kExitUsage);
  EXPECT_EQ(nothing.error_tail, "facetless: bench needs a file, --published or --structures\n");
  const ChildOutcome broken = Run({Sample("broken/wrong_type.step")});
  EXPECT_EQ(broken.exit_code, kExitUnusable);
  EXPECT_EQ(std::count(broken.error_tail.begin(), broken.error_tail.end(), '\n'), 1) << broken.error_tail;
  EXPECT_EQ(Run({Sample("sphere.step"), "--repeats", "0"}).exit_code, kExitUsage);
  const ChildOutcome timeout = Run({Sample("sphere.step"), "--timeout", "5"});
  EXPECT_EQ(timeout.exit_code, kExitUsage) << "--time-limit bounds each mesh of the bench";
  EXPECT_THAT(timeout.error_tail, HasSubstr("--timeout"));
}

}  // namespace
}  // namespace facetless
