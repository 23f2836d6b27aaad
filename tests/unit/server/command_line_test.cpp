// Tests the program as a process: exit codes, and what it prints to which stream.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "server/base/exit_code.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

class CommandLine : public testing::Test {
 protected:
  ChildOutcome Run(const std::vector<std::string>& arguments) {
    return RunProgram(Program("facetless"), arguments, directory_.path(), environment_);
  }
  // Runs a command on a file with the given text, which selects the behaviour of the fake importer
  // (tests/support/fake_importer).
  ChildOutcome RunFake(const std::string& command, const std::string& text,
                       std::vector<std::string> arguments) {
    environment_ = {"FACETLESS_IMPORTER=" + Program("facetless-fake-importer"), "TMPDIR=" + scratch_.path()};
    arguments.insert(arguments.begin(), {command, WriteText(directory_.File("part.step"), text)});
    const ChildOutcome outcome = Run(arguments);
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "temporary files were left behind";
    return outcome;
  }
  TempDir directory_ = TempDir::Create().value(), scratch_ = TempDir::Create().value();
  std::vector<std::string> environment_;
};

TEST_F(CommandLine, Helps) {
  const ChildOutcome help = Run({"--help"});
  EXPECT_EQ(help.exit_code, kExitDone);
  for (const char* command : {"inspect", "render", "mesh", "compare", "regress", "serve"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    const ChildOutcome more = Run({command, "--help"});
    EXPECT_EQ(more.exit_code, kExitDone);
    EXPECT_THAT(more.out, HasSubstr("Example")) << command;
  }
  const ChildOutcome version = Run({"--version"});
  EXPECT_EQ(version.exit_code, kExitDone);
  EXPECT_THAT(version.out, testing::StartsWith("facetless 0."));
}

TEST_F(CommandLine, NamesFacesWithoutATriangle) {
  const std::string out = directory_.File("part.glb");
  EXPECT_EQ(RunFake("mesh", "ok", {"--out", out}).exit_code, kExitDone);
  const ChildOutcome lacking = RunFake("mesh", "unmeshed", {"--out", out});
  EXPECT_EQ(lacking.exit_code, kExitLost);
  EXPECT_THAT(lacking.error_tail, HasSubstr("the mesh lacks the face part/cone #12"));
  EXPECT_EQ(RunFake("mesh", "unmeshed", {"--out", out, "--strict"}).exit_code, kExitFailed);
}

TEST_F(CommandLine, MeshIsWrittenInTheFormatOfItsNameAndSaysWhetherItIsClosed) {
  for (const char* suffix : {".glb", ".stl", ".obj", ".3mf"}) {
    const std::string out = directory_.File(std::string("part") + suffix);
    const ChildOutcome written = RunFake("mesh", "ok", {"--out", out});
    EXPECT_EQ(written.exit_code, kExitDone) << written.error_tail;
    EXPECT_EQ(written.out, out + "\n");
    EXPECT_THAT(written.error_tail, HasSubstr("2 triangles; not watertight: 4 open edges"));
    EXPECT_TRUE(std::filesystem::exists(out));
  }
  EXPECT_TRUE(std::filesystem::exists(directory_.File("part.mtl")));
  // The first bytes must be those of the format.
  EXPECT_EQ(ReadText(directory_.File("part.glb")).substr(0, 4), "glTF");
  EXPECT_EQ(ReadText(directory_.File("part.stl")).size(), 84u + 2 * 50);
  EXPECT_EQ(ReadText(directory_.File("part.3mf")).substr(0, 4), "PK\3\4");
  const ChildOutcome refused = RunFake("mesh", "hang", {"--out", directory_.File("part.ply")});
  EXPECT_EQ(refused.exit_code, kExitUsage);
  EXPECT_THAT(refused.error_tail, HasSubstr(".glb, .stl, .obj, .3mf; not .ply"));
}

TEST_F(CommandLine, RefusesWrongOptionsBeforeAnyWork) {
  const std::string file = WriteText(directory_.File("part.step"), "hang");
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"paint"},
      {"inspect"},
      {"render", file},
      {"render", file, "--out", "d", "--view", "above"},
      {"render", file, "--out", "d", "--size", "big"},
      {"render", file, "--out", "d", "--samples", "7"},
      {"render", file, "--out", "d", "--camera", "{"},
      {"render", file, "--out", "d", "--camera", "@absent.json"},
      {"render", file, "--out", "d", "--aov", "curvature"},
      {"render", file, "--out", "d", "--colour", "red"},
      {"render", file, "--out", "d", "--shade", "tiger"},
      {"render", file, "--out", "d", "--shade", "zebra:stripes=none"},
      {"compare", file, "--out", "d", "--shade", "curvature"},
      {"compare", file, "--out", "d", "--deflection", "0"},
      {"compare", file, "--out", "d", "--deflection", "1e-3", "--deflection-mm", "1"},
      {"compare", file, "--out", "d", "--mesh", "m.glb", "--mesh-unit", "parsec"},
      {"compare", file, "--out", "d", "--mesh-unit", "in"},
      {"mesh", file},
      {"mesh", file, "--out", "part.ply"},
      {"mesh", file, "--out", "part"},
      {"serve", "--listen", "nowhere"},
      {"serve", "--jobs", "0"}};
  for (const auto& arguments : wrong) {
    const ChildOutcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, kExitUsage) << testing::PrintToString(arguments);
    EXPECT_NE(outcome.error_tail, "") << testing::PrintToString(arguments);
    EXPECT_EQ(outcome.out, "") << testing::PrintToString(arguments);
  }
  EXPECT_THAT(Run({"paint"}).error_tail, HasSubstr("no command \"paint\"; the commands are inspect, "));
}

TEST_F(CommandLine, InspectGivesJson) {
  const ChildOutcome outcome = RunFake("inspect", "ok", {});
  EXPECT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json.at("model").at("faces"), 1);
  EXPECT_TRUE(json.at("facetless").contains("isa"));
}

TEST_F(CommandLine, SaysInOneSentenceWhyAFileCannotBeUsed) {
  const ChildOutcome unusable = RunFake("inspect", "unusable nothing-usable", {});
  EXPECT_EQ(unusable.exit_code, kExitUnusable);
  EXPECT_EQ(unusable.error_tail, "facetless: nothing in here\n");
  EXPECT_EQ(unusable.out, "");
  EXPECT_EQ(RunFake("inspect", "crash", {}).exit_code, kExitUnusable);
  EXPECT_EQ(RunFake("inspect", "garbage", {}).exit_code, kExitUnusable);
  const ChildOutcome hanging = RunFake("inspect", "hang", {"--import-timeout", "0.3"});
  EXPECT_EQ(hanging.exit_code, kExitUnusable);
  EXPECT_THAT(hanging.error_tail, HasSubstr("use --import-timeout to allow more"));
  EXPECT_EQ(Run({"inspect", "absent.step"}).exit_code, kExitUnusable);
}

TEST_F(CommandLine, PrintsProgressWhereItIsWanted) {
  EXPECT_EQ(RunFake("inspect", "ok", {}).error_tail, "");
  EXPECT_EQ(RunFake("inspect", "ok", {"--progress"}).error_tail, "read 50%\ntransfer 100%\n");
}

TEST_F(CommandLine, RenderWritesItsFilesAndPrintsThePathOfTheReport) {
  const std::string out = directory_.File("new/images");
  const ChildOutcome outcome =
      RunFake("render", "ok",
              {"--out", out, "--view", "top", "--view", "iso", "--size", "40x30", "--aov", "depth,uv"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  EXPECT_EQ(outcome.out, out + "/report.json\n");
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(out)) files.insert(file.path().filename());
  EXPECT_EQ(files, (std::set<std::string>{"report.json", "report.html", "top.direct.png", "top.depth.tif",
                                          "top.aov.exr", "iso.direct.png", "iso.depth.tif", "iso.aov.exr"}));
  const Json report = Json::parse(ReadText(out + "/report.json"));
  EXPECT_EQ(report.at("views").size(), 2u);
  EXPECT_EQ(report["views"][0].at("camera").at("width"), 40);
  EXPECT_EQ(report["views"][0].at("files").at("direct"), "top.direct.png");
  // The camera of a report must give the same picture again.
  const std::string camera = WriteText(directory_.File("camera.json"), report["views"][0]["camera"].dump());
  const std::string again = directory_.File("again");
  ASSERT_EQ(RunFake("render", "ok", {"--out", again, "--camera", "@" + camera}).exit_code, kExitDone);
  EXPECT_EQ(ReadText(again + "/camera.direct.png"), ReadText(out + "/top.direct.png"));
  EXPECT_EQ(ReadText(again + "/camera.depth.tif"), ReadText(out + "/top.depth.tif"));
}

TEST_F(CommandLine, AnInspectionWritesItsLegendAndItsNumbers) {
  const std::string out = directory_.File("inspected");
  const ChildOutcome outcome = RunFake(
      "render", "ok", {"--out", out, "--view", "top", "--size", "40x30", "--shade", "curvature:range=-1..1"});
  ASSERT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  std::set<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(out)) files.insert(file.path().filename());
  EXPECT_EQ(files, (std::set<std::string>{"report.json", "report.html", "top.direct.png", "top.depth.tif",
                                          "top.legend.png", "top.inspection.tif"}));
  const Json report = Json::parse(ReadText(out + "/report.json"));
  EXPECT_EQ(report.at("options").at("shade"), "curvature:kind=mean,range=-1..1");
  const Json& view = report.at("views")[0];
  EXPECT_EQ(view.at("files").at("inspection"), "top.inspection.tif");
  EXPECT_EQ(view.at("inspection").at("direct").at("unit"), "1/mm");
  EXPECT_EQ(view["inspection"]["direct"].at("range"), Json({-1, 1}));
  EXPECT_TRUE(report.at("continuity").at("counts").contains("G1"));
}

TEST_F(CommandLine, ContinuityGivesJson) {
  const ChildOutcome outcome = RunFake("continuity", "ok", {});
  EXPECT_EQ(outcome.exit_code, kExitDone) << outcome.error_tail;
  EXPECT_EQ(Json::parse(outcome.out).at("continuity").at("counts").at("G0"), 0);
}

TEST_F(CommandLine, SaysWhenItCannotWrite) {
  WriteText(directory_.File("file"), "in the way");
  const ChildOutcome outcome =
      RunFake("render", "ok", {"--out", directory_.File("file/images"), "--size", "8x8"});
  EXPECT_EQ(outcome.exit_code, kExitCannotWrite);
  EXPECT_THAT(outcome.error_tail, HasSubstr("cannot make the directory"));
}

TEST_F(CommandLine, RegressWritesReferencesPassesAndNoticesAChange) {
  WriteText(directory_.File("part.step"), "ok");
  const std::string manifest =
      WriteText(directory_.File("manifest.json"),
                R"({"defaults": {"size": "48x48", "samples": 1, "tolerances": {"depth_mm": 0}},
                                             "files": [{"file": "part.step", "view": ["top", "iso"]}]})");
  environment_ = {"FACETLESS_IMPORTER=" + Program("facetless-fake-importer")};
  EXPECT_EQ(Run({"regress", manifest}).exit_code, kExitFailed) << "there are no references yet";
  const ChildOutcome updated = Run({"regress", manifest, "--update"});
  ASSERT_EQ(updated.exit_code, kExitDone) << updated.error_tail << updated.out;
  const ChildOutcome passed = Run({"regress", manifest});
  EXPECT_EQ(passed.exit_code, kExitDone) << passed.out;
  EXPECT_TRUE(Json::parse(passed.out).at("passed").get<bool>());

  // Change the reference of one view.
  const std::string references = directory_.File("references/");
  std::filesystem::copy_file(references + "part.iso.png", references + "part.top.png",
                             std::filesystem::copy_options::overwrite_existing);
  const ChildOutcome failed = Run({"regress", manifest, "--out", directory_.File("failures")});
  EXPECT_EQ(failed.exit_code, kExitFailed);
  const Json views = Json::parse(failed.out).at("files").at(0).at("views");
  EXPECT_FALSE(views.at(0).at("passed").get<bool>());
  EXPECT_EQ(views.at(0).at("broken").at(0).at("tolerance"), "max");
  EXPECT_TRUE(views.at(1).at("passed").get<bool>());
  for (const char* role : {"image", "reference", "difference", "side-by-side"})
    EXPECT_TRUE(std::filesystem::exists(directory_.File("failures/part.top." + std::string(role) + ".png")))
        << role;

  // Change the size.
  WriteText(manifest, R"({"files": [{"file": "part.step", "view": "iso", "size": "32x32", "samples": 1}]})");
  EXPECT_EQ(Run({"regress", manifest}).exit_code, kExitSize);
}

TEST_F(CommandLine, StopsOnCtrlCAndLeavesNothing) {
  const std::string file = WriteText(directory_.File("part.step"), "hang");
  const std::string program = Program("facetless"), importer = Program("facetless-fake-importer");
  const pid_t child = fork();
  if (child == 0) {
    setenv("FACETLESS_IMPORTER", importer.c_str(), 1);
    setenv("TMPDIR", scratch_.path().c_str(), 1);
    execl(program.c_str(), program.c_str(), "inspect", file.c_str(), nullptr);
    _exit(127);
  }
  // The importer's directory appears just before the importer starts.
  for (int i = 0; i < 1000 && std::filesystem::is_empty(scratch_.path()); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status)) << "the program died of signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), kExitSignal + SIGINT);
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

}  // namespace
}  // namespace facetless
