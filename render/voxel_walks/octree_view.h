// OctreeView: the rays of a camera through an octree, tile by tile of the picture.
//
//     const VoxelCamera camera(frame, grid, 512, 512);
//     const OctreeView view(octree, camera);
//     if (!view.MayHit(column, row)) continue;  // no ray of the tile meets anything
//     VoxelRay ray;
//     if (!camera.EnterPixel(column + 0.5, row + 0.5, octree.size(), &ray)) continue;
//     const VoxelHit hit = view.Walk(column, row, ray, camera.Footprint(), &counters);
//
//  1. The non-empty cubes of one level of the tree, and the larger leaves, are projected once. Each tile of the picture lists
//     those whose projections meet it, in the order in which its rays pass them. A ray enters the tree at the cubes of its
//     tile's list, and reads no node above them.
//  2. The hits are those of the walk "descent", bit for bit. A cube is projected with a margin that is more than the rounding
//     of rays, so that a list lacks no cube that a ray of the tile visits. Which of them the ray visits is decided by its
//     planes, as always.
//  3. Rays whose components have other signs than those of the ray through the tile's centre pass cubes in another order;
//     they go down from the root.
#pragma once

#include <cstdint>
#include <vector>

#include "render/voxel_walks/descend.h"
#include "render/voxel_walks/voxel_camera.h"

namespace facetless {

class OctreeView {
 public:
  static constexpr int kTile = 4;  // pixels on a side of a tile

  // Requires the camera and the model to outlive the view, and footprints (voxel_walk.h, law 2) of at most that of the
  // camera's pixels.
  OctreeView(const OctreeModel& model, const VoxelCamera& camera);

  // Whether the list of the pixel's tile has cubes.
  bool MayHit(int column, int row) const {
    const std::size_t tile = TileOf(column, row);
    return first_[tile] < first_[tile + 1];
  }
  // Requires a ray through a point of the pixel.
  VoxelHit Walk(int column, int row, const VoxelRay& ray, const WalkOptions& options,
                WalkCounters* counters) const;
  std::uint64_t bytes() const;

 private:
  static constexpr int kLevel = 3;  // of the cubes, if no level of detail is coarser

  struct TileRange {
    int first_column, last_column, first_row, last_row;  // of tiles; empty if first > last
    bool empty() const { return first_column > last_column || first_row > last_row; }
  };
  // A direction of the camera: the coordinate of a voxel's lowest corner along it is at + Dot(voxel, step), in mm from the eye.
  struct Direction {
    double at;
    Vec3 step;
    double reach;  // of a cube that is two voxels wide, from its centre
  };
  std::size_t TileOf(int column, int row) const {
    return static_cast<std::size_t>(row / kTile) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column / kTile);
  }
  void Collect(const OctreeNode& node, VoxelPoint low, int level, int cut, std::vector<TileRange>* ranges);
  TileRange Project(VoxelPoint low, int level) const;
  void FillLists(const std::vector<TileRange>& ranges);
  void OrderLists();

  const OctreeModel& model_;
  const VoxelCamera& camera_;
  int columns_, rows_;  // of tiles
  Direction right_, down_, forward_;
  double margin_ = 0;                  // mm, for the rounding of rays and projections
  unsigned descends_ = 0;              // the axes on which the ray through the picture's centre descends
  std::vector<OctreeCube> cubes_;      // in the coordinates of that ray, in the order in which it passes them
  std::vector<std::uint8_t> octants_;  // the axes on which the ray through each tile's centre descends
  std::vector<std::uint32_t> first_;   // of each tile's list, and the end
  std::vector<std::uint32_t> lists_;   // cubes
};

}  // namespace facetless
