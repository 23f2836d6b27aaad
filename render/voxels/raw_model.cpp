#include "render/voxels/raw_model.h"

#include <algorithm>

namespace facetless {

RawModel::RawModel(VoxelPoint size) : VoxelModel(size), voxels_(VoxelBox{{0, 0, 0}, size}.volume()) {}

RawModel::RawModel(const RunModel& runs) : RawModel(runs.size()) {
  for (int x = 0; x < size().x; ++x)
    for (int y = 0; y < size().y; ++y)
      for (const VoxelRun& run : runs.Column(x, y))
        Fill({{x, y, run.z_begin}, {x + 1, y + 1, run.z_end}}, run.voxel);
}

void RawModel::VisitColumn(int x, int y, const std::function<void(const VoxelRun&)>& visit) const {
  if (x < 0 || y < 0 || x >= size().x || y >= size().y) return;
  const Voxel* column = voxels_.data() + Index({x, y, 0});
  for (int z = 0; z < size().z;) {
    const Voxel voxel = column[z];
    int end = z + 1;
    while (end < size().z && column[end] == voxel) ++end;
    if (voxel.filled()) visit({z, end, voxel});
    z = end;
  }
}

void RawModel::Fill(const VoxelBox& region, Voxel voxel) {
  const VoxelBox inside = Intersection(region, box());
  if (inside.empty()) return;
  for (int x = inside.low.x; x < inside.high.x; ++x)
    for (int y = inside.low.y; y < inside.high.y; ++y)
      std::fill_n(voxels_.begin() + static_cast<std::ptrdiff_t>(Index({x, y, inside.low.z})),
                  inside.high.z - inside.low.z, voxel);
}

void RawModel::SetColumn(int x, int y, std::span<const VoxelRun> runs) {
  Fill({{x, y, 0}, {x + 1, y + 1, size().z}}, {});
  for (const VoxelRun& run : runs) Fill({{x, y, run.z_begin}, {x + 1, y + 1, run.z_end}}, run.voxel);
}

}  // namespace facetless
