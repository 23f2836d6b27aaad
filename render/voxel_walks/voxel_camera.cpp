#include "render/voxel_walks/voxel_camera.h"

#include <algorithm>

namespace facetless {

VoxelCamera::VoxelCamera(const CameraFrame& camera_frame, const VoxelGrid& voxel_grid, int width, int height)
    : frame(camera_frame), grid(voxel_grid), width_px(width), height_px(height) {
  const Box3 bounds = grid.bounds();
  if (frame.projection == Projection::kOrthographic)
    before = Dot(bounds.center() - frame.eye, frame.forward) - bounds.diagonal();
}

bool VoxelCamera::EnterPixel(double x, double y, VoxelPoint size, VoxelRay* ray) const {
  const double scale = 1 / grid.pitch;
  const Ray line = PixelRay(frame, x, y);
  return ray->Enter(scale * (line.origin + before * line.direction - grid.origin), scale * line.direction,
                    frame.projection == Projection::kPerspective ? frame.near_mm : 0, size);
}

WalkOptions VoxelCamera::Footprint() const {
  const double pixel = std::max(frame.pixel_x, frame.pixel_y) / grid.pitch;
  return frame.projection == Projection::kPerspective ? WalkOptions{.footprint_0 = 0, .footprint = pixel}
                                                      : WalkOptions{.footprint_0 = pixel, .footprint = 0};
}

}  // namespace facetless
