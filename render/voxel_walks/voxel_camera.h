// VoxelCamera: the rays of a camera in the coordinates of a voxel model.
//
//     const VoxelCamera camera(MakeFrame(view, diagonal).value(), grid, 512, 512);
//     VoxelRay ray;
//     if (camera.EnterPixel(column + 0.5, row + 0.5, model.size(), &ray)) hit = walk->Walk(ray, camera.Footprint(), &counters);
//     depth = camera.before + hit.t;
#pragma once

#include "render/view/camera.h"
#include "render/voxel_walks/voxel_walk.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

struct VoxelCamera {
  VoxelCamera(const CameraFrame& frame, const VoxelGrid& grid, int width_px, int height_px);

  // Prepares the ray through pixel coordinates (x, y). Returns false if it misses the model. The depth of a hit is
  // before + t.
  bool EnterPixel(double x, double y, VoxelPoint size, VoxelRay* ray) const;
  // How wide a pixel is, for levels of detail: footprint_0 in orthographic views, footprint in perspective ones.
  WalkOptions Footprint() const;

  CameraFrame frame;
  VoxelGrid grid;
  int width_px, height_px;
  double before = 0;  // the depth at which rays begin: in front of the model in orthographic views
};

}  // namespace facetless
