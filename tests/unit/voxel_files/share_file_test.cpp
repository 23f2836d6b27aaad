// Files of shares: the voxels are read again from .vti, and the numbers are those of every voxel, x fastest.
#include "render/voxel_files/share_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "render/voxel_files/voxel_file.h"
#include "tests/support/random_voxels.h"
#include "tests/support/temporary_folder.h"

namespace facetless {
namespace {

using testing::AnyModel;
using ::testing::HasSubstr;

// Shares that differ from voxel to voxel; some are empty.
VoxelShares AnyShares(const VoxelGrid& grid) {
  VoxelShares shares;
  shares.grid = grid;
  for (int x = 0; x < grid.size.x; ++x) {
    VoxelShares::Slab slab;
    slab.first.push_back(0);
    for (int y = 0; y < grid.size.y; ++y) {
      for (int z = 0; z < grid.size.z;) {
        const int end = std::min(z + *rc::gen::inRange(1, 4), grid.size.z);
        if (*rc::gen::inRange(0, 3) > 0)
          slab.runs.push_back(
              {z, end, 0.01f * float(*rc::gen::inRange(0, 101)), 0.001f * float(*rc::gen::inRange(1, 99))});
        z = end;
      }
      slab.first.push_back(static_cast<std::uint32_t>(slab.runs.size()));
    }
    shares.slabs.push_back(std::move(slab));
  }
  return shares;
}

// The floating-point numbers in `bytes`, `behind` bytes before the end.
std::vector<float> FloatsBefore(const std::string& bytes, std::size_t behind, std::size_t count) {
  std::vector<float> numbers(count);
  std::memcpy(numbers.data(), bytes.data() + bytes.size() - behind - count * sizeof(float),
              count * sizeof(float));
  return numbers;
}

RC_GTEST_PROP(ShareFiles, HoldEveryVoxel, ()) {
  const RunModel model = AnyModel(9);
  const VoxelPoint n = model.size();
  const VoxelGrid grid{{1, -2, 0.5}, 0.25, n};
  const VoxelShares shares = AnyShares(grid);
  const TemporaryFolder folder;
  const auto bytes_of = [&](const std::string& name) {
    const std::string path = folder.File(name);
    const auto written = WriteShares(path, model, shares, nullptr);
    if (!written.ok()) RC_FAIL(written.error().message);
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  };
  const std::string vti = bytes_of("a.vti"), nrrd = bytes_of("a.nrrd");
  const std::size_t count = static_cast<std::size_t>(model.box().volume());
  const std::size_t end = std::string("\n</AppendedData>\n</VTKFile>\n").size();
  const std::vector<float> bound = FloatsBefore(vti, end, count),
                           share =
                               FloatsBefore(vti, end + count * sizeof(float) + sizeof(std::uint64_t), count),
                           pairs = FloatsBefore(nrrd, 0, 2 * count);
  std::size_t i = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x, ++i) {
        const ShareRun expected = shares.Get(x, y, z);
        RC_ASSERT(share[i] == expected.share && bound[i] == expected.bound);
        RC_ASSERT(pairs[2 * i] == expected.share && pairs[2 * i + 1] == expected.bound);
      }
  RC_ASSERT(nrrd.find("sizes: 2 " + std::to_string(n.x) + " ") != std::string::npos);
  Result<VoxelFile> read = ReadVoxels(folder.File("a.vti"), std::uint64_t{1} << 30);
  RC_ASSERT(read.ok());
  RC_ASSERT(SameVoxels(*read.value().model, model));
  RC_ASSERT(read.value().grid && read.value().grid->pitch == grid.pitch);
}

TEST(ShareFiles, RefuseOtherFormatsAndStopWhenCancelled) {
  const TemporaryFolder folder;
  RunModel model({3, 3, 3});
  VoxelShares shares;
  shares.grid = {{0, 0, 0}, 1, {3, 3, 3}};
  shares.slabs.assign(3, {{0, 0, 0, 0}, {}});
  EXPECT_THAT(WriteShares(folder.File("a.oct"), model, shares, nullptr).error().message,
              HasSubstr("only .vti and .nrrd"));
  const std::atomic<bool> cancel{true};
  for (const char* name : {"a.vti", "a.nrrd"}) {
    EXPECT_EQ(WriteShares(folder.File(name), model, shares, &cancel).error().code, ErrorCode::kCancelled);
    EXPECT_FALSE(std::ifstream(folder.File(name)).good());
  }
}

}  // namespace
}  // namespace facetless
