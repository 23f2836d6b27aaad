// Voxels of the samples and of real files against OpenCASCADE's classifier and the oracle. facetless_voxel_check takes any
// files and more centres.
#include "tests/verify/voxel_check/voxel_check.h"

#include <gtest/gtest.h>

#include <cctype>
#include <string>

#include "tests/support/files.h"

namespace facetless {
namespace {

void Check(const std::string& path) {
  const Result<VoxelCheck> check = CheckVoxels(path, {.resolution = 128, .far = 300, .near = 20});
  ASSERT_TRUE(check.ok()) << check.error().message;
  EXPECT_EQ(check.value().far.wrong + check.value().near.wrong, 0u) << check.value().first_wrong;
  EXPECT_GT(check.value().filled, 0u);
  EXPECT_GT(check.value().far.inside, 0u);
  EXPECT_LT(check.value().far.inside, check.value().far.centres);
  EXPECT_LE(check.value().far.undecided, check.value().far.centres / 20);
  EXPECT_LE(check.value().near.undecided, check.value().near.centres / 2);
}

std::string TestName(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

class SampleVoxels : public ::testing::TestWithParam<const char*> {};

TEST_P(SampleVoxels, AreInsideAsTheReferencesSay) {
  Check(Sample(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(All, SampleVoxels,
                         ::testing::Values("assembly.step", "bracket.step", "cone.step", "sphere.step",
                                           "torus.step"),
                         [](const auto& info) { return TestName(info.param); });

class RealVoxels : public ::testing::TestWithParam<const char*> {};

TEST_P(RealVoxels, AreInsideAsTheReferencesSay) {
  const std::string path = CadFile(std::string("parts/") + GetParam());
  if (path.empty())
    GTEST_SKIP()
        << GetParam()
        << " does not exist, so nothing was compared. Set FACETLESS_CAD to the folder of real files.";
  Check(path);
}

INSTANTIATE_TEST_SUITE_P(All, RealVoxels,
                         ::testing::Values("332_file.stp", "revolved_sphere.step",
                                           "nist_stc_06_asme1_ap242-e3.stp"),
                         [](const auto& info) { return TestName(info.param); });

}  // namespace
}  // namespace facetless
