// Files of OpenVDB: ours lose nothing, and those of other programs are read by what their grids mean.
#include "openvdb/grid_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <rapidcheck/gtest.h>

#include "tests/support/random_voxels.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using testing::AnyModel;
using ::testing::HasSubstr;

constexpr std::uint64_t kMemory = std::uint64_t{1} << 28;

class OpenVdbFiles : public ::testing::Test {
 protected:
  OpenVdbFiles() { openvdb::initialize(); }
  Result<VoxelFile> Read(const openvdb::GridPtrVec& grids, double threshold = 0,
                         std::uint64_t max_bytes = kMemory) const {
    const std::string path = folder_.File("a.vdb");
    openvdb::io::File(path).write(grids);
    return ReadGrids(path, threshold, max_bytes);
  }
  const TemporaryFolder folder_;
};

RC_GTEST_FIXTURE_PROP(OpenVdbFiles, LoseNothing, ()) {
  const RunModel model = AnyModel(30);
  const VoxelGrid grid{{0.1 * *rc::gen::inRange(-50, 50), 1e3, -3e-5},
                       std::exp2(*rc::gen::inRange(-20, 30)) / 3,
                       model.size()};
  const std::string path = folder_.File("b.vdb");
  const bool small = grid.pitch < 2e-5;
  RC_ASSERT(WriteGrids(path, model, grid).ok() != small);
  if (small) return;
  const Result<VoxelFile> read = ReadGrids(path, 0, kMemory);
  if (model.Count() == 0) {
    RC_ASSERT(read.error().code == ErrorCode::kNothingUsable);
    return;
  }
  RC_ASSERT(read.ok());
  RC_ASSERT(SameVoxels(*read.value().model, model));
  RC_ASSERT(read.value().grid.has_value());
  RC_ASSERT(read.value().grid->pitch == grid.pitch);
  RC_ASSERT(Length(read.value().grid->origin - grid.origin) <= 1e-6 * (1 + grid.pitch));
}

TEST_F(OpenVdbFiles, TilesCountAsTheirVoxels) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("smoke");
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
  grid->tree().addTile(2, openvdb::Coord(0, 128, -128), 0.75f, true);
  grid->tree().setValue(openvdb::Coord(-5, 130, -130), 0.25f);
  const auto read = Read({grid});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read.value().model->size(), (VoxelPoint{133, 128, 130}));
  EXPECT_EQ(read.value().model->Count(), 128u * 128 * 128 + 1);
  EXPECT_EQ(read.value().grid->pitch, 0.25);
  EXPECT_EQ(read.value().grid->Center({5, 0, 2}).y, 128 * 0.25);
  EXPECT_EQ(Read({grid}, 0.5).value().model->Count(), 128u * 128 * 128);
  EXPECT_EQ(Read({grid}, 0, 1 << 16).error().code, ErrorCode::kLimitExceeded);
}

TEST_F(OpenVdbFiles, ALevelSetIsFilledWhereItIsNegative) {
  const auto grid = openvdb::DoubleGrid::create(3);
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  // A band of active voxels, positive outside and negative inside, around an inactive tile inside.
  grid->tree().fill(openvdb::CoordBBox(openvdb::Coord(-2), openvdb::Coord(17)), 0.5, true);
  grid->tree().fill(openvdb::CoordBBox(openvdb::Coord(-1), openvdb::Coord(16)), -0.5, true);
  grid->tree().fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(15)), -3, false);
  const auto read = Read({grid});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read.value().model->size(), (VoxelPoint{18, 18, 18}));
  EXPECT_EQ(read.value().model->Count(), 18u * 18 * 18);
}

TEST_F(OpenVdbFiles, GridsOfOtherTypes) {
  const auto mask = openvdb::MaskGrid::create();
  mask->tree().setValue(openvdb::Coord(1, 2, 3), true);
  EXPECT_EQ(Read({mask}).value().model->Count(), 1u);
  const auto flags = openvdb::BoolGrid::create(false);
  flags->tree().setValue(openvdb::Coord(1, 2, 3), true);
  flags->tree().setValue(openvdb::Coord(1, 2, 4), false);
  EXPECT_EQ(Read({flags}).value().model->Count(), 1u);
  const auto velocity = openvdb::Vec3SGrid::create(openvdb::Vec3s(0));
  velocity->setName("vel");
  const auto refused = Read({velocity});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("it has vel of type vec3s"));
  const auto whole = openvdb::Int32Grid::create(0);
  whole->setTransform(std::make_shared<openvdb::math::Transform>(
      openvdb::math::MapBase::Ptr(new openvdb::math::ScaleMap(openvdb::Vec3d(1, 1, 2)))));
  whole->tree().setValue(openvdb::Coord(0), 7);
  const auto read = Read({velocity, whole});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read.value().grid);
  EXPECT_THAT(read.value().warnings, ::testing::Contains(HasSubstr("cubes")));
}

TEST_F(OpenVdbFiles, HugeTilesAreRefused) {
  const auto grid = openvdb::FloatGrid::create(0);
  grid->tree().addTile(3, openvdb::Coord(0), 1, true);
  grid->tree().setValue(openvdb::Coord(1 << 29, 0, 0), 1);
  const auto read = Read({grid});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kLimitExceeded);
  EXPECT_EQ(Read({[] {
              auto far = openvdb::FloatGrid::create(0);
              far->tree().setValue(openvdb::Coord(-2147483647 - 1, 0, 0), 1);
              far->tree().setValue(openvdb::Coord(2147483647, 0, 0), 1);
              return far;
            }()})
                .error()
                .code,
            ErrorCode::kLimitExceeded);
}

}  // namespace
}  // namespace facetless
