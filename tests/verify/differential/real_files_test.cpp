// Compares the direct renderer with OpenCASCADE's exact intersector on the samples and on the real files.
// This tests the claims of docs/accuracy-results.md with fewer rays.
//
// Rays that pass an edge within its tolerance, so that the shape does not determine what they hit, and rays
// on which the reference is proven wrong do not count against the renderer. All others do.

#include <gtest/gtest.h>

#include <cctype>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <string>
#include <utility>

#include "tests/support/files.h"
#include "tests/verify/differential/differential.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;

// The required values.
constexpr double kWithin = 0.999;   // share of depths that agree
constexpr double kHitMiss = 0.001;  // largest share of rays that hit for one and miss for the other

// Returns the number of rays per side of the picture. The reference takes about as long on a heavy file as on
// a light one.
int SizeFor(std::size_t faces) {
  return faces <= 300 ? 96 : faces <= 1000 ? 64 : 48;
}

std::uint64_t Count(const ViewComparison& view, Verdict verdict) {
  return view.counts[static_cast<std::size_t>(verdict)];
}

void CompareViews(const fs::path& path, bool one_placement) {
  Result<ComparedFile> file = LoadBoth(path.string(), one_placement);
  ASSERT_TRUE(file.ok()) << file.error().message;
  const Scene scene(file.value().model);
  const int size = SizeFor(file.value().reference.face_count());
  for (const auto& [name, projection] :
       {std::pair{"iso", Projection::kOrthographic}, std::pair{"iso-back", Projection::kPerspective}}) {
    const Result<Camera> camera = NamedView(name, file.value().model.bounds, projection, size, size);
    ASSERT_TRUE(camera.ok()) << camera.error().message;
    const Result<ViewComparison> compared = CompareView(file.value(), scene, camera.value());
    ASSERT_TRUE(compared.ok()) << compared.error().message;
    const ViewComparison& view = compared.value();
    // Describe each difference.
    std::string differences;
    for (const Difference& difference : view.differences)
      differences += Describe(difference, file.value()) + "\n";
    SCOPED_TRACE(view.view + "\n" + differences);
    std::cout << view.view << ": " << view.rays << " rays, " << view.both_hit << " hit by both, "
              << 100 * view.ShareWithin() << " % within, " << view.hit_miss << " hit and miss, "
              << view.differences.size() << " differences, " << view.Defects() << " defects\n";

    EXPECT_GT(view.both_hit, 0u);
    EXPECT_EQ(view.Defects(), 0u);
    EXPECT_LE(view.ShareHitMiss(), kHitMiss);
    // Differences in which the side of an edge speaks against us must be within the edge's tolerance, and
    // rare.
    const std::uint64_t excused = Count(view, Verdict::kEdgeForOurs) + Count(view, Verdict::kReferenceLost) +
                                  Count(view, Verdict::kReferenceInvented) +
                                  Count(view, Verdict::kReferenceImprecise);
    EXPECT_GE(static_cast<double>(view.both_within + excused), kWithin * static_cast<double>(view.both_hit));
    // Only a small share of rays may be excused, since the reference is accurate.
    EXPECT_LE(static_cast<double>(excused), 0.01 * static_cast<double>(view.both_hit) + 1);
  }
}

class SampleFile : public ::testing::TestWithParam<const char*> {};

TEST_P(SampleFile, AgreesWithTheReference) {
  CompareViews(Sample(GetParam()), false);
}

// Converts a file name to the name of a test.
std::string TestName(std::string name) {
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, SampleFile,
                         ::testing::Values("assembly.step", "blade.step", "bracket.step", "cone.step",
                                           "freeform.step", "sphere.step", "teapot.step", "torus.step",
                                           "trimmed.iges", "wavy_sheet.step"),
                         [](const auto& info) { return TestName(info.param); });

struct RealFileCase {
  const char* name;
  bool one_placement = false;  // there are too many placed faces for the reference
};

void PrintTo(const RealFileCase& r, std::ostream* out) {
  *out << r.name;
}

class RealFile : public ::testing::TestWithParam<RealFileCase> {};

TEST_P(RealFile, AgreesWithTheReference) {
  const std::string path = CadFile(std::string("parts/") + GetParam().name);
  if (path.empty())
    GTEST_SKIP()
        << GetParam().name
        << " does not exist, so nothing was compared. Set FACETLESS_CAD to the folder of real files.";
  CompareViews(path, GetParam().one_placement);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealFile,
    ::testing::Values(
        RealFileCase{"NIST_MBE_PMI_11.stp"}, RealFileCase{"NIST_MBE_PMI_2.stp"},
        RealFileCase{"NIST_MBE_PMI_3.stp"}, RealFileCase{"nist_ctc_01_asme1_ap242-e1.stp"},
        RealFileCase{"nist_ctc_02_asme1_ap242-e2.stp"}, RealFileCase{"nist_ctc_05_asme1_ap242-e1.stp"},
        RealFileCase{"nist_stc_06_asme1_ap242-e3.stp"}, RealFileCase{"ExpansionCard_ThreadedInsert.stp"},
        RealFileCase{"propeller_and_shaft.iges"}, RealFileCase{"tip.iges"}, RealFileCase{"c172.igs"},
        RealFileCase{"geo_example_screwed.igs"}, RealFileCase{"fuse.igs"}, RealFileCase{"IEA_15MW_CFD.igs"},
        RealFileCase{"nacelle.stp"}, RealFileCase{"D150WithGuides_wing.igs"},
        RealFileCase{"boxed_sphere.step"}, RealFileCase{"revolved_sphere.step"},
        RealFileCase{"Generator_detail.STEP"}, RealFileCase{"332_file.stp"}, RealFileCase{"cube.iges"},
        RealFileCase{"Gs037.stp"}, RealFileCase{"instances_4096_3level.step", true}),
    [](const auto& info) { return TestName(info.param.name); });

}  // namespace
}  // namespace facetless
