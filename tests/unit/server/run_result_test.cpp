// The result of a run lists what it has written and measured, so that no program has to read its report.
#include "server/run/run_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "server/base/exit_code.h"
#include "server/run/run.h"
#include "server/run/trade.h"
#include "tests/unit/server/parsed_options.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using Json = nlohmann::json;

class RunResults : public testing::Test {
 protected:
  ImportRequest RequestFor(const std::string& sample) {
    ImportRequest request;
    request.input = Sample(sample);
    return request;
  }
  // The files in the directory must be those that the result names, each once, with the names of the report.
  void ExpectAllFilesNamed(const RunResult& result) {
    std::set<std::string> named, there;
    for (const RunFile& file : result.files.list()) {
      EXPECT_TRUE(named.insert(file.name).second) << file.name;
      EXPECT_FALSE(file.role.empty());
    }
    for (const std::string& frame : result.files.frames()) EXPECT_TRUE(named.insert(frame).second) << frame;
    for (const auto& entry : std::filesystem::directory_iterator(out_)) there.insert(entry.path().filename());
    EXPECT_EQ(named, there);
    EXPECT_EQ(Json::parse(ReadText(out_ + "/report.json")), result.report);
    for (const Json& view : result.report.at("views"))
      for (const auto& [role, name] : view.at("files").items())
        EXPECT_EQ(result.files.Json(view.at("name")).at(role), name);
    const Json files = result.report.value("files", Json::object());
    for (const auto& [role, name] : files.items()) EXPECT_EQ(result.files.Json("").at(role), name);
    EXPECT_EQ(VerdictJson(result.verdict), result.report.at("verdict"));
  }

  const ScopedEnvironment importer_{"FACETLESS_IMPORTER", Program("facetless-import")};
  TempDir directory_ = TempDir::Create().value();
  const std::string out_ = directory_.File("out");
};

TEST_F(RunResults, OfARenderNameEveryFileAndEveryTrace) {
  const auto imported = Import(RequestFor("cone.step"));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const RunOptions options = ParsedOptions(
      R"({"size":"48x40","view":["iso","top"],"sheet":true,"turntable":3,"svg":true,"aov":"uv,certificate"})");
  const auto result = RunRender(imported.value(), options, out_, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectAllFilesNamed(result.value());
  EXPECT_THAT(result.value().files.frames(), SizeIs(3));
  EXPECT_EQ(result.value().report.at("turntable").at("frames"), Json(result.value().files.frames()));
  ASSERT_THAT(result.value().traced, SizeIs(2)) << "one for each view";
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(result.value().traced[i].rays, result.value().report.at("views").at(i).at("direct").at("rays"));
  EXPECT_THAT(result.value().warnings, IsEmpty());
  EXPECT_EQ(result.value().verdict.exit_code, kExitDone);
  EXPECT_FALSE(result.value().no_baseline);
}

TEST_F(RunResults, OfAComparisonNameTheFilesOfTheMeshToo) {
  ImportRequest request = RequestFor("cone.step");
  request.meshes = {{.deflection = 1e-2}};
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const RunOptions options = ParsedOptions(
      R"({"size":"48x40","mesh_deviation":true,"sheet":true,"fail_deviation_mm":1e-9,"shade":"curvature"})");
  const auto result = RunCompare(imported.value(), imported.value().meshes.front(), options, out_, {});
  ASSERT_FALSE(result.ok()) << "a mesh has no curvature";
  RunOptions studio = options;
  studio.inspection = {};
  const auto compared = RunCompare(imported.value(), imported.value().meshes.front(), studio, out_, {});
  ASSERT_TRUE(compared.ok()) << compared.error().message;
  ExpectAllFilesNamed(compared.value());
  EXPECT_EQ(compared.value().files.Json("").at("mesh"), "mesh.bin");
  EXPECT_EQ(compared.value().verdict.exit_code, kExitFailed);
  ASSERT_THAT(compared.value().verdict.broken, SizeIs(1));
  EXPECT_EQ(compared.value().verdict.broken.front().threshold, "fail_deviation_mm");
}

TEST_F(RunResults, WithoutABaselineSayWhyAndTakeAnotherReason) {
  const auto imported = Import(RequestFor("cone.step"));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  auto result = RunWithoutBaseline(imported.value(), {"timeout", "it took too long"},
                                   ParsedOptions(R"({"size":"48x40"})"), out_, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectAllFilesNamed(result.value());
  ASSERT_TRUE(result.value().no_baseline);
  EXPECT_EQ(result.value().no_baseline->reason, "timeout");
  result = WithReason(std::move(result).value(), {"memory", "it was too large"}, out_);
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectAllFilesNamed(result.value());
  EXPECT_EQ(result.value().no_baseline->message, "it was too large");
  EXPECT_EQ(result.value().verdict.problems, std::vector<std::string>{"it was too large"});
  EXPECT_EQ(result.value().verdict.exit_code, kExitNoBaseline);
}

TEST_F(RunResults, OfATradeNameThePlots) {
  const ImportRequest request = RequestFor("cone.step");
  const auto imported = Import(request);
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const auto result = RunTrade(
      request, imported.value(),
      ParsedOptions(R"({"size":"32x32","deflections":"1e-1","angles":"30","tolerances":"1e-3"})"), out_, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  ExpectAllFilesNamed(result.value().run);
  const Json files = result.value().run.files.Json("iso");
  for (const char* role :
       {"direct", "trade-time.svg", "trade-time.png", "trade-memory.svg", "trade-memory.png"})
    EXPECT_TRUE(files.contains(role)) << role;
}

TEST_F(RunResults, WarnOfTheSideThatIsMeasured) {
  // Seen from below, a sheet shows its back.
  const auto imported = Import(RequestFor("wavy_sheet.step"));
  ASSERT_TRUE(imported.ok()) << imported.error().message;
  const auto result = RunRender(
      imported.value(), ParsedOptions(R"({"size":"48x40","view":"bottom","shade":"curvature"})"), out_, {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  const Json& inspection = result.value().report.at("views").at(0).at("inspection").at("direct");
  ASSERT_TRUE(inspection.contains("note"));
  EXPECT_EQ(result.value().warnings,
            std::vector<std::string>{"bottom: " + inspection["note"].get<std::string>()});
}

TEST(RunFiles, OfOneViewAndRoleAreReplaced) {
  RunFiles files;
  files.Add("iso", "direct", "a.png");
  files.Add("iso", "direct", "b.png");
  files.Add("", "direct", "c.png");
  EXPECT_EQ(files.Json("iso"), Json({{"direct", "b.png"}}));
  EXPECT_EQ(files.Json(""), Json({{"direct", "c.png"}}));
  EXPECT_TRUE(files.Json("top").is_null());
}

}  // namespace
}  // namespace facetless
