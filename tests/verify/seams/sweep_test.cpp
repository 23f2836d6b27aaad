// On the samples, and on real files if they are available, no ray may cross a closed solid an odd number of
// times, and all rays must meet backwards what they meet forwards.
#include "tests/verify/seams/sweep.h"

#include <gtest/gtest.h>

#include "tests/support/files.h"

namespace facetless {
namespace {

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
    ExpectTight(Sample(name), 48, 100);
    ++files;
  }
  EXPECT_EQ(files, 10);
}

class SweepOfRealFile : public ::testing::TestWithParam<const char*> {};

TEST_P(SweepOfRealFile, LetsNoLightThrough) {
  const std::string path = CadFile(std::string("parts/") + GetParam());
  if (path.empty())
    GTEST_SKIP() << GetParam() << " is not available: set FACETLESS_CAD to the folder of CAD files";
  ExpectTight(path, 64, 100);
}

// Edges without p-curves, up to 0.006 mm off their faces; a wing; an assembly; spheres in a box.
INSTANTIATE_TEST_SUITE_P(Parts, SweepOfRealFile,
                         ::testing::Values("NIST_MBE_PMI_2.stp", "nist_ctc_01_asme1_ap242-e1.stp",
                                           "D150WithGuides_wing.igs", "ExpansionCard_ThreadedInsert.stp",
                                           "boxed_sphere.step"));

}  // namespace
}  // namespace facetless
