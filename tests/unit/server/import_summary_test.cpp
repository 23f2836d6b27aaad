// The importer's answer is parsed into a struct, whatever the answer contains.

#include "server/importer/import_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace facetless {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

TEST(ImportSummary, HasWhatTheImporterSaysOfEachMesh) {
  const ImportSummary summary = ReadImportSummary(nlohmann::json::parse(R"({
    "faces": 6,
    "meshes": [{"mesh_ms": 12.5, "peak_bytes": 1048576, "faces_unmeshed": ["#17", "lid"]},
               {"mesh_ms": 40, "peak_bytes": 2097152, "faces_unmeshed": []}],
    "exact": {"rays": 3, "trace_ms": 0.25}})"),
                                                  2);
  ASSERT_THAT(summary.meshes, SizeIs(2));
  EXPECT_EQ(summary.meshes[0].mesh_ms, 12.5);
  EXPECT_EQ(summary.meshes[0].peak_bytes, 1048576u);
  EXPECT_THAT(summary.meshes[0].faces_unmeshed, ElementsAre("#17", "lid"));
  EXPECT_EQ(summary.meshes[1].mesh_ms, 40);
  EXPECT_THAT(summary.meshes[1].faces_unmeshed, IsEmpty());
  EXPECT_EQ(summary.exact_ms, 0.25);
}

TEST(ImportSummary, TakesWhatIsMissingOrOfAnotherKindForNothing) {
  for (const char* answer :
       {"null", "[]", "7", R"({"meshes": {}})", R"({"meshes": [1, "a"]})", R"({"exact": []})",
        R"({"meshes": [{"mesh_ms": "12", "peak_bytes": -1, "faces_unmeshed": "lid"}, null]})",
        R"({"meshes": [{"faces_unmeshed": [1, null, {}]}], "exact": {"trace_ms": "1"}})"}) {
    const ImportSummary summary = ReadImportSummary(nlohmann::json::parse(answer), 2);
    EXPECT_EQ(summary.exact_ms, 0) << answer;
    ASSERT_THAT(summary.meshes, SizeIs(2)) << answer;
    for (const MesherReport& mesh : summary.meshes) {
      EXPECT_EQ(mesh.mesh_ms, 0) << answer;
      EXPECT_EQ(mesh.peak_bytes, 0u) << answer;
      EXPECT_THAT(mesh.faces_unmeshed, IsEmpty()) << answer;
    }
  }
}

TEST(ImportSummary, HasAsManyMeshesAsWereAskedFor) {
  const auto answer = nlohmann::json::parse(R"({"meshes": [{"mesh_ms": 1}, {"mesh_ms": 2}]})");
  EXPECT_THAT(ReadImportSummary(answer, 0).meshes, IsEmpty());
  ASSERT_THAT(ReadImportSummary(answer, 1).meshes, SizeIs(1));
  EXPECT_EQ(ReadImportSummary(answer, 1).meshes[0].mesh_ms, 1);
}

}  // namespace
}  // namespace facetless
