// A short run of facetless_mutations on the project's own samples. Thousands of mutants are run by hand
// (docs/reliability.md).
#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "tests/system/http/live_server.h"
#include "tests/unit/server/support.h"
#include "tests/verify/mutations/judge.h"
#include "tests/verify/mutations/mutate.h"

namespace facetless {
namespace {

class Mutations : public testing::Test {
 protected:
  static void ExpectAnswers(MutationRun run) {
    run.seed = 20261122;
    run.limits = {20, 2048};
    const nlohmann::json report = RunMutations(run);
    EXPECT_TRUE(report["offences"].empty()) << report["offences"].dump(1);
    EXPECT_EQ(report["mutants"], run.files.size() * run.count);
  }
};

TEST_F(Mutations, AreTheSameForTheSameSeedAndIndex) {
  for (const char* sample : {"sphere.step", "trimmed.iges"}) {
    const std::string original = ReadText(Sample(sample));
    std::set<std::string> different;
    for (std::uint64_t index = 0; index < 50; ++index) {
      const Mutant mutant = MakeMutant(original, 7, index);
      EXPECT_EQ(mutant.bytes, MakeMutant(original, 7, index).bytes);
      EXPECT_FALSE(mutant.what.empty());
      different.insert(mutant.bytes);
    }
    EXPECT_GT(different.size(), 45u) << sample;
  }
}

TEST_F(Mutations, OfCadFilesAllGetAnAnswer) {
  MutationRun run;
  for (const char* sample : {"sphere.step", "bracket.step", "assembly.step", "trimmed.iges"})
    run.files.push_back(Sample(sample));
  run.count = 12;
  ExpectAnswers(run);
}

TEST_F(Mutations, OfMeshesAllGetAnAnswer) {
  const TempDir directory = TempDir::Create().value();
  const std::string glb = directory.File("sphere.glb");
  const ChildOutcome meshed =
      RunProgram(Program("facetless"), {"mesh", Sample("sphere.step"), "--out", glb}, directory.path());
  ASSERT_EQ(meshed.exit_code, 0) << meshed.error_tail;
  MutationRun run;
  run.files = {glb, Sample("broken/mesh.stl")};
  run.count = 200;
  ExpectAnswers(run);
}

TEST_F(Mutations, PostedToTheServiceAllGetAnAnswer) {
  LiveServer server;
  MutationRun run;
  run.files = {Sample("torus.step"), Sample("trimmed.iges")};
  run.count = 8;
  run.host = "127.0.0.1";
  run.port = server.port();
  ExpectAnswers(run);
  // The service itself renders the mutants that it can import.
  run.count = 4;
  run.options = R"({"size":"64x48","lines":"hidden","section":"x=0"})";
  ExpectAnswers(run);
  EXPECT_TRUE(server.Running());
}

}  // namespace
}  // namespace facetless
