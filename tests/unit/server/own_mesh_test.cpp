// Comparisons whose mesh is not made: the exact half comes first and is kept. A fake importer writes its
// model, begins to mesh and then does what its input says (tests/support/fake_importer). The last test uses
// the real importer.
#include "server/run/own_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <thread>

#include "server/base/exit_code.h"
#include "tests/support/files.h"
#include "tests/support/sanitized.h"
#include "tests/unit/server/fake_import.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::json;

class OwnMesh : public FakeImport {
 protected:
  ChildOutcome Compare(const std::string& mode, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"compare", WriteText(inputs_.File("part.step"), mode), "--out",
                               out_.File("compared"), "--size", "32x24", "--samples", "1"});
    const ChildOutcome outcome =
        RunProgram(Program("facetless"), more, out_.path(), {"TMPDIR=" + scratch_.path()});
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "temporary files were left behind";
    return outcome;
  }
  Json Report() const {
    return Json::parse(ReadText(out_.File("compared/report.json")), nullptr, /*allow_exceptions=*/false);
  }
  bool Exists(const std::string& name) const {
    return std::filesystem::exists(out_.File("compared/" + name));
  }
  // Checks that the exact half is there, and that one sentence says why the other half is missing.
  void ExpectExactHalf(const ChildOutcome& outcome, const std::string& reason, const std::string& words,
                       const std::string& remedy) {
    EXPECT_EQ(outcome.exit_code, kExitNoBaseline) << outcome.error_tail;
    EXPECT_EQ(outcome.out, out_.File("compared/report.json\n"));
    for (const char* file : {"iso.direct.png", "iso.depth.tif", "report.html"})
      EXPECT_TRUE(Exists(file)) << file;
    EXPECT_FALSE(Exists("iso.baseline.png"));
    const Json report = Report();
    EXPECT_EQ(report.at("command"), "compare");
    EXPECT_GT(report.at("views").at(0).at("direct").at("hits"), 0);
    EXPECT_FALSE(report["views"][0].contains("baseline"));
    EXPECT_EQ(report.at("no_baseline").at("reason"), reason);
    const std::string message = report["no_baseline"].at("message");
    EXPECT_THAT(message, StartsWith("part.step: "));
    EXPECT_THAT(message, HasSubstr(words));
    EXPECT_THAT(message, HasSubstr(remedy));
    EXPECT_EQ(report.at("verdict").at("exit_code"), kExitNoBaseline);
    EXPECT_FALSE(report["verdict"].at("passed").get<bool>());
    EXPECT_EQ(report["verdict"].at("problems"), Json::array({message}));
    EXPECT_EQ(outcome.error_tail, "facetless: failed: " + message + "\n");
  }
  TempDir out_ = TempDir::Create().value();
};

TEST_F(OwnMesh, IsComparedWhenTheMesherIsDone) {
  EXPECT_EQ(Compare("mesh-ok").exit_code, kExitDone);
  EXPECT_TRUE(Exists("iso.baseline.png"));
  EXPECT_FALSE(Report().contains("no_baseline"));
}

TEST_F(OwnMesh, TakesOverFromTheEarlyPicturesOfASlowMesher) {
  EXPECT_EQ(Compare("mesh-slow 2500").exit_code, kExitDone);
  EXPECT_TRUE(Exists("iso.baseline.png"));
  EXPECT_FALSE(Report().contains("no_baseline"));
  EXPECT_GT(Report().at("timing_ms").at("import"), 2000);
}

TEST_F(OwnMesh, ThatTakesTooLongLeavesTheExactHalf) {
  ExpectExactHalf(Compare("mesh-hang", {"--mesh-timeout", "0.3"}), "timeout",
                  "meshing took longer than 0.3 s",
                  "use --mesh-timeout to allow more, and a coarser --deflection needs less");
  // The result must be the same if the exact pictures were made early.
  ExpectExactHalf(Compare("mesh-spin", {"--mesh-timeout", "2.5"}), "timeout",
                  "meshing took longer than 2.5 s",
                  "a render (facetless render, POST /v1/renders) needs no mesh");
}

TEST_F(OwnMesh, ThatCrashesLeavesTheExactHalf) {
  ExpectExactHalf(Compare("mesh-crash"), "crash", "the mesher was killed by SIGSEGV", "another --deflection");
  ExpectExactHalf(Compare("mesh-garbage"), "crash", "gave up with exit code 0", "render");
}

TEST_F(OwnMesh, ThatNeedsTooMuchMemoryLeavesTheExactHalf) {
  if (kSanitized) GTEST_SKIP() << "sanitizers need more address space than a limit allows";
  ExpectExactHalf(Compare("mesh-memory", {"--import-memory", "300"}), "memory",
                  "meshing needs more than 300 MB of memory", "use --import-memory to allow more");
}

TEST_F(OwnMesh, ThatTheMesherRefusesLeavesTheExactHalf) {
  ExpectExactHalf(Compare("mesh-unusable write-failed"), "failed", "nothing in here", "render");
}

TEST_F(OwnMesh, DoesNotExcuseAFileThatCannotBeRead) {
  EXPECT_EQ(Compare("hang", {"--import-timeout", "0.3", "--mesh-timeout", "60"}).exit_code, kExitUnusable);
  EXPECT_EQ(Compare("crash").exit_code, kExitUnusable);
  EXPECT_FALSE(Exists("report.json"));
}

TEST_F(OwnMesh, HasABudgetBesideThatOfTheImport) {
  // Reading may take at most a second here, and meshing takes longer than that.
  EXPECT_EQ(Compare("mesh-slow 1200", {"--import-timeout", "1", "--mesh-timeout", "60"}).exit_code,
            kExitDone);
}

TEST_F(OwnMesh, DoesNotExcuseWhatElseFails) {
  const ChildOutcome outcome = Compare("mesh-crash", {"--section", "z=-500"});
  EXPECT_EQ(outcome.exit_code, kExitFailed);
  EXPECT_EQ(Report().at("verdict").at("problems").size(), 2u);
}

TEST_F(OwnMesh, IsWhatTheMeshCommandIsFor) {
  const std::string file = WriteText(inputs_.File("part.step"), "mesh-hang");
  const ChildOutcome outcome =
      RunProgram(Program("facetless"),
                 {"mesh", file, "--out", out_.File("part.stl"), "--mesh-timeout", "0.3"}, out_.path());
  EXPECT_EQ(outcome.exit_code, kExitUnusable);
  EXPECT_EQ(
      outcome.error_tail,
      "facetless: part.step: meshing took longer than 0.3 s; use --mesh-timeout to allow more, and a coarser "
      "--deflection needs less\n");
}

TEST_F(OwnMesh, IsNotWaitedForByTheExactPictures) {
  const std::string file = WriteText(inputs_.File("part.step"), "mesh-hang"), program = Program("facetless"),
                    out = out_.File("compared");
  const pid_t child = fork();
  if (child == 0) {
    setenv("TMPDIR", scratch_.path().c_str(), 1);
    execl(program.c_str(), program.c_str(), "compare", file.c_str(), "--out", out.c_str(), "--size", "32x24",
          nullptr);
    _exit(127);
  }
  // The mesher never ends. The report is written last.
  while (!Exists("report.html")) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(Exists("iso.direct.png"));
  EXPECT_EQ(Report().at("no_baseline").at("reason"), "pending");
  EXPECT_EQ(waitpid(child, nullptr, WNOHANG), 0) << "the comparison ended too early";
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kExitSignal + SIGTERM);
  EXPECT_TRUE(std::filesystem::is_empty(scratch_.path()));
}

TEST_F(OwnMesh, OfARealFileMayTakeLongerThanItsBudget) {
  unsetenv("FACETLESS_IMPORTER");
  // A chord error of 1e-6 of its size keeps the mesher busy for a large part of a minute.
  const ChildOutcome outcome =
      RunProgram(Program("facetless"),
                 {"compare", Sample("sphere.step"), "--out", out_.File("compared"), "--size", "32x24",
                  "--deflection", "1e-6", "--mesh-timeout", "0.2"},
                 out_.path());
  EXPECT_EQ(outcome.exit_code, kExitNoBaseline) << outcome.error_tail;
  EXPECT_THAT(outcome.error_tail, HasSubstr("sphere.step: meshing took longer than 0.2 s"));
  EXPECT_EQ(Report().at("no_baseline").at("reason"), "timeout");
  EXPECT_GT(Report().at("views").at(0).at("direct").at("hits"), 0);
}

TEST_F(OwnMesh, WhoseSearchTreeIsTooLargeLeavesTheExactHalf) {
  unsetenv("FACETLESS_IMPORTER");
  const std::vector<std::string> fine = {
      "compare", Sample("sphere.step"), "--out", out_.File("compared"), "--size",
      "32x24",   "--deflection",        "1e-4"};
  std::vector<std::string> bounded = fine;
  bounded.insert(bounded.end(), {"--max-view-memory", "1"});
  const ChildOutcome outcome = RunProgram(Program("facetless"), bounded, out_.path());
  EXPECT_EQ(outcome.exit_code, kExitNoBaseline) << outcome.error_tail;
  EXPECT_THAT(
      outcome.error_tail,
      HasSubstr("sphere.step: the mesh's search tree needs more than the 1 MB of memory that it may take; "
                "use --max-view-memory to allow more, and a coarser mesh needs less; "));
  EXPECT_EQ(Report().at("no_baseline").at("reason"), "memory");
  EXPECT_GT(Report().at("views").at(0).at("direct").at("hits"), 0);
  EXPECT_EQ(RunProgram(Program("facetless"), fine, out_.path()).exit_code, kExitDone);
  EXPECT_GT(Report().at("views").at(0).at("baseline").at("bvh_bytes"), 1 << 20);
}

TEST_F(OwnMesh, WhoseSearchTreeLeavesTooLittleForTheLeavesLeavesTheExactHalf) {
  unsetenv("FACETLESS_IMPORTER");
  // The tree takes 9 MB, and 14 MB while it is built. The view's leaves need more than 12 MB, and less than
  // 14.
  const ChildOutcome outcome =
      RunProgram(Program("facetless"),
                 {"compare", Sample("wavy_sheet.step"), "--out", out_.File("compared"), "--samples", "1",
                  "--deflection", "1e-4", "--max-view-memory", "17"},
                 out_.path());
  EXPECT_EQ(outcome.exit_code, kExitNoBaseline) << outcome.error_tail;
  EXPECT_THAT(outcome.error_tail, HasSubstr("wavy_sheet.step: beside the mesh's search tree of "));
  EXPECT_EQ(Report().at("no_baseline").at("reason"), "memory");
  EXPECT_GT(Report().at("views").at(0).at("direct").at("hits"), 0);
}

TEST_F(OwnMesh, OfAnotherProgramMustFitToo) {
  unsetenv("FACETLESS_IMPORTER");
  const std::string mesh = out_.File("sphere.stl");
  ASSERT_EQ(RunProgram(Program("facetless"),
                       {"mesh", Sample("sphere.step"), "--out", mesh, "--deflection", "1e-4"}, out_.path())
                .exit_code,
            kExitDone);
  const ChildOutcome outcome =
      RunProgram(Program("facetless"),
                 {"compare", Sample("sphere.step"), "--mesh", mesh, "--out", out_.File("compared"), "--size",
                  "32x24", "--max-view-memory", "1"},
                 out_.path());
  EXPECT_EQ(outcome.exit_code, kExitUnusable);
  EXPECT_THAT(outcome.error_tail, HasSubstr("the mesh's search tree needs more than the 1 MB"));
}

}  // namespace
}  // namespace facetless
