// `facetless render` with a voxel file.
#include "server/run/voxel_render.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "render/image/io.h"
#include "render/voxel_files/voxel_file.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/run_model.h"

namespace facetless {
namespace {

std::string Folder() {
  const std::string folder = ::testing::TempDir() + "voxel_render";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

// Writes a file of a tower on a floor.
std::string Tower(const std::string& directory, const std::string& suffix) {
  RunModel model({30, 30, 30});
  model.Fill({{0, 0, 0}, {30, 30, 2}}, Voxel::Of(90, 160, 90));
  model.Fill({{12, 12, 2}, {18, 18, 25}}, Voxel::Of(180, 80, 60, 7));
  const std::string path = directory + "/tower" + suffix;
  EXPECT_TRUE(WriteVoxels(path, model, {{10, 20, 30}, 2, model.size()}).ok());
  return path;
}

RunOptions Small() {
  return ParseOptions({{"size", "48x40"}, {"samples", 1}}).value();
}

TEST(VoxelRender, EveryFormatAndEveryWalk) {
  const std::string directory = Folder();
  const std::string out = directory + "/tower.png";
  for (const VoxelFormat& format : VoxelFormats()) {
    const auto result = RunVoxelRender(Tower(directory, std::string(format.suffix)), Small(), out, {});
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_GT(result.value()["rays"]["primary"]["hits"], 150) << format.suffix;
    EXPECT_EQ(result.value()["voxels"]["encoding"], "octree");
  }
  const std::string file = Tower(directory, ".oct");
  const auto usual = RunVoxelRender(file, Small(), out, {});
  EXPECT_EQ(usual.value()["voxels"]["pitch_mm"], 2);
  EXPECT_EQ(usual.value()["camera"]["target"], nlohmann::json({40.0, 50.0, 55.0}));
  const Image8 expected = ReadPng(out).value();
  EXPECT_EQ(expected.width, 48);
  EXPECT_EQ(expected.height, 40);
  for (const NamedVoxelWalk& walk : VoxelWalks()) {
    RunOptions options = Small();
    options.voxel_picture.walk = walk.name;
    const auto result = RunVoxelRender(file, options, out, {});
    ASSERT_TRUE(result.ok()) << result.error().message;
    EXPECT_EQ(result.value()["walk"], walk.name);
    EXPECT_EQ(result.value()["voxels"]["encoding"], walk.encoding);
    EXPECT_EQ(ReadPng(out).value().bytes == expected.bytes, walk.exact) << walk.name;
  }
}

TEST(VoxelRender, LightsAndNormalsChangeThePicture) {
  const std::string directory = Folder();
  const std::string file = Tower(directory, ".oct"), out = directory + "/tower.png";
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const nlohmann::json& more : {nlohmann::json::object(),
                                     nlohmann::json{{"ambient", 0.1}},
                                     {{"point_light", "0,0,200"}},
                                     {{"point_light", {"0,0,200", "100,50,90,0.2,0.2,1"}}},
                                     {{"side_normals", true}}}) {
    nlohmann::json given = {{"size", "48x40"}, {"samples", 1}};
    given.update(more);
    const auto result = RunVoxelRender(file, ParseOptions(given).value(), out, {});
    ASSERT_TRUE(result.ok());
    pictures.push_back(ReadPng(out).value().bytes);
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) EXPECT_NE(pictures[i], pictures.back()) << more;
  }
}

TEST(VoxelRender, Refusals) {
  const std::string directory = Folder();
  const std::string file = Tower(directory, ".oct"), out = directory + "/tower.png";
  const auto message = [&](const nlohmann::json& more, const std::string& path) {
    const auto result = RunVoxelRender(file, ParseOptions(more).value(), path, {});
    return result.ok() ? std::string() : result.error().message;
  };
  EXPECT_NE(message(nlohmann::json::object(), directory).find("is a .png file"), std::string::npos);
  EXPECT_NE(message({{"view", {"iso", "top"}}}, out).find("from one view"), std::string::npos);
  EXPECT_NE(message({{"walk", "sideways"}}, out).find("there are: grid"), std::string::npos);
  EXPECT_NE(message({{"walk", "kd-shortstack:0"}}, out).find("from 1 to 25"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(ParseOptions({{"point_light", "1,2"}}).ok());
  EXPECT_FALSE(ParseOptions({{"point_light", "1,2,3,-1,0,0"}}).ok());

  EXPECT_TRUE(CheckRenderOptions({"view", "walk", "background"}, true).ok());
  EXPECT_TRUE(CheckRenderOptions({"view", "shade"}, false).ok());
  EXPECT_NE(CheckRenderOptions({"view", "shade"}, true).error().message.find("shade:"), std::string::npos);
  EXPECT_NE(CheckRenderOptions({"ambient"}, false).error().message.find("only pictures of voxel files"),
            std::string::npos);
}

// A file of some hundred bytes can claim four billion columns.
TEST(VoxelRender, AnEmptyGiantIsNoWork) {
  const std::string directory = Folder();
  OctreeModel model({1 << 16, 1 << 16, 1 << 16});
  model.Fill({{5, 6, 7}, {105, 106, 57}}, Voxel::Of(90, 160, 90));
  const std::string path = directory + "/giant.oct";
  ASSERT_TRUE(WriteVoxels(path, model, {{0, 0, 0}, 1, model.size()}).ok());
  const auto result = RunVoxelRender(path, Small(), directory + "/giant.png", {});
  ASSERT_TRUE(result.ok()) << result.error().message;
  // The view shows the filled voxels.
  EXPECT_EQ(result.value()["camera"]["target"], nlohmann::json({55.0, 56.0, 32.0}));
  EXPECT_GT(result.value()["rays"]["primary"]["hits"], 500);
  // Other encodings are made of the columns.
  RunOptions options = Small();
  options.voxel_picture.walk = "bricks";
  options.accuracy.max_bytes = std::uint64_t{1} << 30;
  const auto refused = RunVoxelRender(path, options, directory + "/giant.png", {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kLimitExceeded);
}

TEST(VoxelRender, DamagedFilesGiveOneError) {
  const std::string directory = Folder();
  const std::string file = Tower(directory, ".oct");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const auto result = RunVoxelRender(file, Small(), directory + "/x.png", {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kFormatBroken);
}

}  // namespace
}  // namespace facetless
