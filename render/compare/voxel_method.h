// The method "voxels": a model is shown as the voxels of its exact solids (render/voxels/voxelize.h), in an octree.
#pragma once

#include <memory>
#include <string>

#include "render/compare/method.h"
#include "render/compare/representation.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/voxel_grid.h"
#include "render/voxels/voxelize.h"

namespace facetless {

// Voxels as a representation that cameras trace.
//
//  1. A ray shows the first filled voxel that it enters, at the depth at which it enters it. Where a pixel is at least two
//     voxels wide, the ray may show a cube of voxels instead, which is no wider than the pixel.
//  2. The normal is the mean direction to the empty voxels within kNormalReach voxels along each axis. Where this direction
//     vanishes or points away from the eye, the normal is that of the side through which the ray entered.
//  3. Voxels name no faces: a picture has the colours of the faces that the reference shows there.
class VoxelSurface final : public Representation {
 public:
  static constexpr int kNormalReach = 2;

  // `stats`: of the voxels, for the facts.
  VoxelSurface(OctreeModel model, VoxelGrid grid, VoxelStats stats, double make_ms, std::string name,
               std::string title)
      : model_(std::move(model)),
        grid_(grid),
        stats_(std::move(stats)),
        make_ms_(make_ms),
        name_(std::move(name)),
        title_(std::move(title)) {}

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  double make_ms() const override { return make_ms_; }
  std::vector<RepresentationFact> facts() const override;
  bool names_faces() const override { return false; }
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  Vec3 NormalAt(VoxelPoint at, int side, Vec3 direction) const;

  const OctreeModel model_;
  const VoxelGrid grid_;
  const VoxelStats stats_;
  const double make_ms_;
  const std::string name_, title_;
};

Method VoxelMethod();

}  // namespace facetless
