#include "render/voxels/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace facetless {
namespace {

bool IsUsable(const Box3& box) {
  const Vec3 side = box.high - box.low;
  return side.x >= 0 && side.y >= 0 && side.z >= 0 && std::isfinite(side.x + side.y + side.z) &&
         std::max({side.x, side.y, side.z}) > 0;
}

// Centres the grid on the box.
VoxelGrid Centred(const Box3& box, double pitch, VoxelPoint size) {
  const Vec3 half = 0.5 * pitch * Vec3{double(size.x), double(size.y), double(size.z)};
  return {box.center() - half, pitch, size};
}

}  // namespace

Result<VoxelGrid> GridOfResolution(const Box3& box, int resolution) {
  if (!IsUsable(box)) return Error{ErrorCode::kBadUsage, "a model without extent has no voxels"};
  if (resolution < 2 || resolution > kMostVoxelsPerAxis)
    return Error{ErrorCode::kBadUsage, "resolution is " + std::to_string(resolution) + ", but must be 2 to " +
                                           std::to_string(kMostVoxelsPerAxis) + " voxels"};
  const Vec3 side = box.high - box.low;
  const double pitch = std::max({side.x, side.y, side.z}) / (resolution - 2 * VoxelGrid::kBorder);
  const auto count = [&](double length) {
    return std::clamp(static_cast<int>(std::ceil(length / pitch + 2 * VoxelGrid::kBorder)), 1, resolution);
  };
  return Centred(box, pitch, {count(side.x), count(side.y), count(side.z)});
}

Result<VoxelGrid> GridOfPitch(const Box3& box, double pitch_mm) {
  if (!IsUsable(box)) return Error{ErrorCode::kBadUsage, "a model without extent has no voxels"};
  const Vec3 side = box.high - box.low;
  const double longest = std::max({side.x, side.y, side.z});
  if (!(pitch_mm > 0) || !(longest / pitch_mm + 2 <= kMostVoxelsPerAxis))
    return Error{ErrorCode::kBadUsage,
                 "pitch_mm must be above 0 and make at most " + std::to_string(kMostVoxelsPerAxis) +
                     " voxels along the longest side, of " + std::to_string(longest) + " mm"};
  const auto count = [&](double length) {
    return static_cast<int>(std::ceil(length / pitch_mm + 2 * VoxelGrid::kBorder));
  };
  return Centred(box, pitch_mm, {count(side.x), count(side.y), count(side.z)});
}

}  // namespace facetless
