// facetless convert: what is said of a conversion, and files of OpenVDB, which another program reads and writes.
#include "server/run/voxel_convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/voxel_files/voxel_file.h"
#include "render/voxels/run_model.h"
#include "server/importer/openvdb_process.h"
#include "server/run/openvdb_format.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Convert : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { AddOpenVdbFormat(); }
  Convert() {
    model_.Fill({{1, 1, 1}, {6, 5, 4}}, Voxel::Of(10, 200, 30, 4));
    model_.Set(0, 5, 4, Voxel::Of(1, 2, 3, 9));
  }
  std::string File(const std::string& name) const { return folder_.File(name); }
  static Result<ConvertResult> Run(const std::string& source, const std::string& target,
                                   const nlohmann::json& options = nlohmann::json::object()) {
    return RunConvert(source, target, ParseOptions(options).value(), {});
  }
  const TemporaryFolder folder_;
  RunModel model_{VoxelPoint{7, 6, 5}};
};

TEST_F(Convert, SaysWhatWasMadeAndWhatIsLost) {
  ASSERT_TRUE(WriteVoxels(File("a.oct"), model_, {{1, 2, 3}, 0.5, model_.size()}));
  const auto nrrd = Run(File("a.oct"), File("a.nrrd"));
  ASSERT_TRUE(nrrd) << nrrd.error().message;
  EXPECT_EQ(nrrd.value().json["voxels"]["size"], nlohmann::json({7, 6, 5}));
  EXPECT_EQ(nrrd.value().json["voxels"]["filled"], model_.Count());
  EXPECT_EQ(nrrd.value().json["voxels"]["pitch_mm"], 0.5);
  EXPECT_EQ(nrrd.value().json["bytes"], std::filesystem::file_size(File("a.nrrd")));
  EXPECT_THAT(nrrd.value().warnings, ::testing::ElementsAre(HasSubstr("no colours")));
  EXPECT_THAT(Run(File("a.oct"), File("a.vti")).value().warnings, IsEmpty());
  const auto unknown = Run(File("a.oct"), File("a.obj"));
  EXPECT_EQ(unknown.error().code, ErrorCode::kBadUsage);
}

TEST_F(Convert, ThePitchIsForFilesThatDoNotSayIt) {
  ASSERT_TRUE(WriteVoxels(File("a.vxl"), model_, {{}, 1, model_.size()}));
  const auto assumed = Run(File("a.vxl"), File("a.oct"));
  EXPECT_THAT(assumed.value().warnings, Contains(HasSubstr("1 mm is assumed")));
  const auto given = Run(File("a.vxl"), File("b.oct"), {{"pitch_mm", 0.25}});
  EXPECT_EQ(given.value().json["voxels"]["pitch_mm"], 0.25);
  EXPECT_THAT(given.value().warnings, IsEmpty());
  const auto ignored = Run(File("b.oct"), File("c.oct"), {{"pitch_mm", 2}});
  EXPECT_EQ(ignored.value().json["voxels"]["pitch_mm"], 0.25);
  EXPECT_THAT(ignored.value().warnings, Contains(HasSubstr("is ignored")));
}

// Each side has its own axis: that of the header for the slices that are read, and --axis for those that are written.
TEST_F(Convert, SlicesAreConvertedToSlicesAcrossAnotherAxis) {
  ASSERT_TRUE(WriteVoxels(File("a.oct"), model_, {{1, 2, 3}, 0.5, model_.size()}));
  ASSERT_TRUE(Run(File("a.oct"), File("y/"), {{"axis", "y"}}));
  const auto made = Run(File("y/"), File("x.tif"), {{"axis", "x"}});
  ASSERT_TRUE(made) << made.error().message;
  ASSERT_TRUE(Run(File("x.tif"), File("b.oct")));
  const auto read = ReadVoxels(File("b.oct"), 1 << 20);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read.value().model->size(), model_.size());
  model_.VisitColumn(0, 5, [&](const VoxelRun& run) {
    EXPECT_EQ(read.value().model->Get(0, 5, run.z_begin).green(), run.voxel.green());
  });
  EXPECT_EQ(read.value().model->Count(), model_.Count());
}

TEST_F(Convert, FilesOfOpenVdbLoseNothing) {
  if (!HasOpenVdb()) GTEST_SKIP() << "this build has no OpenVDB";
  const VoxelGrid grid{{1, 2, 3}, 0.1, model_.size()};
  ASSERT_TRUE(WriteVoxels(File("a.oct"), model_, grid));
  const auto there = Run(File("a.oct"), File("a.vdb"));
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_THAT(there.value().warnings, IsEmpty());
  const auto back = Run(File("a.vdb"), File("b.oct"));
  ASSERT_TRUE(back) << back.error().message;
  const auto read = ReadVoxels(File("b.oct"), 1 << 20);
  EXPECT_TRUE(SameVoxels(*read.value().model, model_));
  EXPECT_EQ(read.value().grid->pitch, grid.pitch);
  EXPECT_EQ(read.value().grid->origin.z, grid.origin.z);
}

// Every prefix of a file, and files with changed bytes, are one error or voxels; nothing is left of a file that failed.
TEST_F(Convert, DamagedFilesOfOpenVdbAreOneError) {
  if (!HasOpenVdb()) GTEST_SKIP() << "this build has no OpenVDB";
  ASSERT_TRUE(WriteVoxels(File("a.vdb"), model_, {{}, 1, model_.size()}));
  std::ifstream in(File("a.vdb"), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  std::size_t errors = 0;
  for (int i = 0; i < 24; ++i) {
    std::string bytes = whole;
    const std::size_t at = whole.size() * static_cast<std::size_t>(i) / 24;
    if (i % 2 == 0) {
      bytes.resize(at);
    } else {
      for (std::size_t k = at; k < std::min(at + 8, bytes.size()); ++k) bytes[k] = static_cast<char>(0xff);
    }
    std::ofstream(File("b.vdb"), std::ios::binary) << bytes;
    const auto read = Run(File("b.vdb"), File("b.oct"), {{"max_view_memory", 256}});
    if (read) {
      std::filesystem::remove(File("b.oct"));
      continue;
    }
    ++errors;
    EXPECT_THAT(read.error().message, AllOf(HasSubstr("b.vdb"), ::testing::Not(HasSubstr("\n")))) << i;
    EXPECT_FALSE(std::filesystem::exists(File("b.oct")));
  }
  EXPECT_GE(errors, 12u) << "half of the files are cut";
}

}  // namespace
}  // namespace facetless
