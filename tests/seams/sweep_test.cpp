// The samples, and real files where they are at hand: no ray crosses a closed solid an odd number of times, and all rays meet backwards what
// they meet forwards.
#include "tests/seams/sweep.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace facetless {
namespace {

namespace fs = std::filesystem;

fs::path FolderFrom(const char* variable) {
  const char* folder = std::getenv(variable);
  return folder != nullptr ? fs::path(folder) : fs::path();
}

std::string Said(const SweepResult& result) {
  std::string text;
  for (const LeakingRay& ray : result.leaking)
    text += ray.view + ", column " + std::to_string(ray.column) + ", row " + std::to_string(ray.row) + ": " +
            ray.crossings + "\n";
  return text;
}

void ExpectTight(const std::string& path, int size, int edges) {
  SCOPED_TRACE(path);
  const Result<Model> model = ImportedModel(path);
  ASSERT_TRUE(model.ok()) << model.error().message;
  const Scene scene(model.value());
  constexpr std::uint64_t kSeed = 11;
  for (const std::vector<SweepView>& views :
       {Around(model.value(), size), AtEdges(model.value(), edges, 16, kSeed)}) {
    const Result<SweepResult> result = Sweep(scene, views);
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_GT(result.value().crossings, 0u);
    EXPECT_EQ(result.value().odd, 0u) << "seed " << kSeed << "\n" << Said(result.value());
    EXPECT_EQ(result.value().mismatched, 0u) << "seed " << kSeed << "\n" << Said(result.value());
  }
}

TEST(Sweep, NoLightThroughTheSamples) {
  int files = 0;
  for (const char* name : {"assembly.step", "blade.step", "bracket.step", "cone.step", "freeform.step",
                           "sphere.step", "teapot.step", "torus.step", "trimmed.iges", "wavy_sheet.step"}) {
    const fs::path path = FolderFrom("FACETLESS_SOURCE") / "samples" / name;
    ASSERT_TRUE(fs::exists(path)) << path;
    ExpectTight(path.string(), 48, 100);
    ++files;
  }
  EXPECT_EQ(files, 10);
}

class SweepOfRealFile : public ::testing::TestWithParam<const char*> {};

TEST_P(SweepOfRealFile, LetsNoLightThrough) {
  const fs::path path = FolderFrom("FACETLESS_CAD") / "parts" / GetParam();
  if (!fs::exists(path))
    GTEST_SKIP() << GetParam() << " is not at hand: set FACETLESS_CAD to the folder of CAD files";
  ExpectTight(path.string(), 64, 100);
}

// Edges without p-curves, up to 0.006 mm off their faces; a wing; an assembly; spheres in a box.
INSTANTIATE_TEST_SUITE_P(Parts, SweepOfRealFile,
                         ::testing::Values("NIST_MBE_PMI_2.stp", "nist_ctc_01_asme1_ap242-e1.stp",
                                           "D150WithGuides_wing.igs", "ExpansionCard_ThreadedInsert.stp",
                                           "boxed_sphere.step"));

}  // namespace
}  // namespace facetless
