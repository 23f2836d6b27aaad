// Pictures of voxels: ambient light, and point lights that cast shadows.
//
//     VoxelPictureOptions options;
//     options.lights = {{.at = {100, -200, 300}}};
//     Result<VoxelPicture> picture = RenderVoxelPicture(*model, grid, camera, options, execution);
//     Result<Image8> image = Encode(picture.value().film);
//
//  1. A pixel shows the colour of the first filled voxel on its ray, times the light that arrives there: the ambient light,
//     and of each point light its colour times the cosine between the normal and the direction to the light, unless a filled
//     voxel lies between. The light does not fade with the distance. Sums are linear, and are clamped when they are encoded.
//  2. Shadow rays use the same walk as the rays of the camera. They begin beside the voxel, kShadowOffset voxels away along
//     the normal of the grid, so that the steps of a slope do not shade it. With the normals of sides, or if a filled voxel
//     is there, they begin on the side.
//  3. Rays are clipped to the model, so that space around it costs nothing. The camera may be inside.
//  4. All exact walks give the same picture, byte for byte; with levels of detail, all walks through octrees do. The number of
//     threads changes nothing.
#pragma once

#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/image/film.h"
#include "render/shade/shade.h"
#include "render/view/camera.h"
#include "render/voxel_walks/voxel_walk.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

struct PointLight {
  Vec3 at;              // mm
  Vec3 color{1, 1, 1};  // linear
};

struct VoxelPictureOptions {
  std::string walk;       // of BindVoxelWalk; empty: octrees are entered tile by tile (octree_view.h)
  double ambient = 0.35;  // linear
  std::vector<PointLight> lights;
  bool grid_normals = true;  // voxel_normal.h; false: the normals of sides
  bool levels = true;        // levels of detail, where a pixel is at least two voxels wide
  Background background = Background::kStudio;
  int samples_x = 1, samples_y = 1;  // of a pixel, on a regular grid
};

struct VoxelPicture {
  Film film;
  WalkCounters primary, shadow;  // rays that meet the model's box, or the lists of their tiles
  std::uint64_t hits = 0;        // of primary rays
  std::uint64_t side_bytes = 0;  // memory besides the model
  double bind_ms = 0, trace_ms = 0;
};

inline constexpr double kShadowOffset = 1.5;

// A light beside the eye of a camera, up and to the left, for pictures without other lights.
PointLight LightBesideEye(const CameraFrame& frame, const VoxelGrid& grid);

// Errors: those of MakeFrame and BindVoxelWalk; kCancelled.
Result<VoxelPicture> RenderVoxelPicture(const VoxelModel& model, const VoxelGrid& grid, const Camera& camera,
                                        const VoxelPictureOptions& options, const Execution& execution);

}  // namespace facetless
