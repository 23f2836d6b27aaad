#include "render/voxels/column_parts.h"

#include <algorithm>

namespace facetless {

Camera ColumnCamera(const VoxelGrid& grid, VoxelAxis axis) {
  const Vec3 low = grid.origin, high = grid.Corner(grid.size), middle = 0.5 * (low + high);
  Camera camera;
  camera.name = "columns";
  camera.target = camera.eye = middle;
  camera.projection = Projection::kOrthographic;
  const auto look = [&](double Vec3::*along, Vec3 up, int width, int height) {
    camera.eye.*along = high.*along;
    camera.up = up;
    camera.width_px = width;
    camera.height_px = height;
    camera.height = height * grid.pitch;
  };
  if (axis == VoxelAxis::kX) look(&Vec3::x, {0, 0, 1}, grid.size.y, grid.size.z);
  if (axis == VoxelAxis::kY) look(&Vec3::y, {0, 0, 1}, grid.size.x, grid.size.z);
  if (axis == VoxelAxis::kZ) look(&Vec3::z, {0, 1, 0}, grid.size.x, grid.size.y);
  return camera;
}

bool ColumnParts::List(std::span<const RayCrossing> crossings) {
  list_.clear();
  open_.clear();
  for (const RayCrossing& crossing : crossings) {
    const std::uint32_t solid = solids_.ClosedSolidOfFace(crossing.placed_face);
    if (solid == kNoIndex) continue;
    // Depths grow downwards.
    const double at = grid_.size.z - crossing.depth / grid_.pitch;
    const auto entered =
        std::find_if(open_.begin(), open_.end(), [&](const Open& o) { return o.solid == solid; });
    if (entered == open_.end()) {
      open_.push_back({solid, at, crossing.placed_face});
      continue;
    }
    list_.push_back({at, entered->at, solid, crossing.placed_face, entered->face});
    open_.erase(entered);
  }
  return !open_.empty();
}

}  // namespace facetless
