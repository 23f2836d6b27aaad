// The method "voxels": a model as voxels of its exact solids (render/voxels/voxelize.h), in an octree.
#pragma once

#include <memory>
#include <string>

#include "render/compare/method.h"
#include "render/compare/representation.h"
#include "render/voxels/octree_model.h"
#include "render/voxels/voxel_grid.h"

namespace facetless {

// Voxels that a camera looks at.
//
//  1. A ray shows the first filled voxel that it enters, at the depth at which it enters it. Where a pixel is wider than a
//     voxel, it shows a cube of voxels no larger than the pixel.
//  2. The normal is that of the surface between filled and empty voxels within kNormalReach voxels, and that of the
//     entered side where there is none.
//  3. Voxels name no faces: a picture has the colours of the faces that the reference shows there.
class VoxelSurface final : public Representation {
 public:
  static constexpr int kNormalReach = 2;

  VoxelSurface(OctreeModel model, VoxelGrid grid, double make_ms, std::string name, std::string title)
      : model_(std::move(model)),
        grid_(grid),
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
  const double make_ms_;
  const std::string name_, title_;
};

Method VoxelMethod();

}  // namespace facetless
