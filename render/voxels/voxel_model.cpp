#include "render/voxels/voxel_model.h"

#include <algorithm>
#include <vector>

#include "render/voxels/encodings.h"

namespace facetless {
namespace {

// The recursion of law 3: the mean of a cube is that of its eight children, weighted by their filled voxels.
struct Cubes {
  const VoxelModel& model;

  std::uint64_t Mean(VoxelPoint low, int level, Voxel* mean) const {
    const VoxelPoint size = model.size();
    *mean = {};
    if (low.x >= size.x || low.y >= size.y || low.z >= size.z) return 0;
    if (level == 0) {
      *mean = model.Get(low.x, low.y, low.z);
      return mean->filled();
    }
    const int half = 1 << (level - 1);
    MeanOfVoxels sum;
    for (int child = 0; child < 8; ++child) {
      Voxel voxel;
      const std::uint64_t filled = Mean(
          {low.x + (child & 1 ? half : 0), low.y + (child & 2 ? half : 0), low.z + (child & 4 ? half : 0)},
          level - 1, &voxel);
      sum.Add(voxel, filled);
    }
    *mean = sum.Get();
    return sum.filled();
  }
};

}  // namespace

VoxelBox Intersection(const VoxelBox& a, const VoxelBox& b) {
  return {{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)},
          {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)}};
}

void MeanOfVoxels::Add(Voxel voxel, std::uint64_t filled) {
  if (filled == 0) return;
  if (filled_ == 0) material_ = voxel.bits & 0xff000000u;
  red_ += filled * voxel.red();
  green_ += filled * voxel.green();
  blue_ += filled * voxel.blue();
  filled_ += filled;
}

Voxel MeanOfVoxels::Get() const {
  if (filled_ == 0) return {};
  const auto rounded = [&](std::uint64_t sum) {
    return static_cast<std::uint32_t>((sum + filled_ / 2) / filled_);
  };
  return {rounded(red_) | rounded(green_) << 8 | rounded(blue_) << 16 | material_};
}

VoxelMean VoxelModel::GetMean(int x, int y, int z, int level) const {
  const int mask = -(1 << level);
  VoxelMean mean;
  if (!box().Holds({x, y, z})) return mean;
  const std::uint64_t filled = Cubes{*this}.Mean({x & mask, y & mask, z & mask}, level, &mean.voxel);
  mean.share = static_cast<double>(filled) / static_cast<double>(std::uint64_t{1} << (3 * level));
  return mean;
}

void VoxelModel::Copy(const VoxelModel& from, const VoxelBox& region, VoxelPoint at) {
  const VoxelBox source = Intersection(region, from.box());
  if (source.empty()) return;
  const VoxelPoint by{at.x - region.low.x, at.y - region.low.y, at.z - region.low.z};
  std::vector<VoxelRun> runs;
  for (int x = source.low.x; x < source.high.x; ++x)
    for (int y = source.low.y; y < source.high.y; ++y) {
      // All runs are read before any is written: the two models may be one.
      runs.clear();
      from.VisitColumn(x, y, [&](const VoxelRun& run) {
        const int begin = std::max(run.z_begin, source.low.z), end = std::min(run.z_end, source.high.z);
        if (begin < end) runs.push_back({begin, end, run.voxel});
      });
      const int to_x = x + by.x, to_y = y + by.y;
      Fill({{to_x, to_y, source.low.z + by.z}, {to_x + 1, to_y + 1, source.high.z + by.z}}, {});
      for (const VoxelRun& run : runs)
        Fill({{to_x, to_y, run.z_begin + by.z}, {to_x + 1, to_y + 1, run.z_end + by.z}}, run.voxel);
    }
}

std::uint64_t VoxelModel::Count() const {
  std::uint64_t count = 0;
  for (int x = 0; x < size().x; ++x)
    for (int y = 0; y < size().y; ++y)
      VisitColumn(x, y,
                  [&](const VoxelRun& run) { count += static_cast<std::uint64_t>(run.z_end - run.z_begin); });
  return count;
}

bool SameVoxels(const VoxelModel& a, const VoxelModel& b) {
  if (!(a.size() == b.size())) return false;
  std::vector<VoxelRun> of_a, of_b;
  for (int x = 0; x < a.size().x; ++x)
    for (int y = 0; y < a.size().y; ++y) {
      of_a.clear();
      of_b.clear();
      a.VisitColumn(x, y, [&](const VoxelRun& run) { of_a.push_back(run); });
      b.VisitColumn(x, y, [&](const VoxelRun& run) { of_b.push_back(run); });
      if (of_a != of_b) return false;
    }
  return true;
}

}  // namespace facetless
