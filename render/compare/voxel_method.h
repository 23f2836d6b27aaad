// The method "voxels": a model is shown as the voxels of its exact solids (render/voxels/voxelize.h).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/compare/method.h"
#include "render/compare/representation.h"
#include "render/voxel_walks/voxel_walk.h"
#include "render/voxels/near_faces.h"
#include "render/voxels/voxel_grid.h"
#include "render/voxels/voxelize.h"

namespace facetless {

// Voxels as a representation that cameras trace.
//
//  1. A ray shows the first filled voxel that it enters, at the depth at which it enters it. Where a pixel is at least four
//     voxels wide, and the encoding has levels of detail, the ray may show a cube of voxels instead, which is no wider than
//     half the pixel.
//  2. With exact normals, the normal and the face are those of the exact surface near the voxel (near_faces.h). Where faces
//     are left out, a ray passes all voxels that no remaining face touches.
//  3. Grid normals are the mean direction to the empty voxels around (voxel_normal.h). With the normals of sides, the normal
//     is that of the side through which the ray entered.
//  4. Without exact normals, voxels name no faces: a picture has the colours of the faces that the reference shows there.
class VoxelSurface final : public Representation {
 public:
  struct Body {
    std::unique_ptr<const VoxelModel> model;
    VoxelGrid grid = {};
    VoxelStats stats = {};                       // for the facts
    std::optional<NearFaces> faces = {};         // for exact normals
    VoxelNormals normals = VoxelNormals::kGrid;  // kExact requires `faces`
    double make_ms = 0;
    std::string name = {}, title = {};
  };
  explicit VoxelSurface(Body body) : body_(std::move(body)), model_(*body_.model), grid_(body_.grid) {}

  std::string name() const override { return body_.name; }
  std::string title() const override { return body_.title; }
  double make_ms() const override { return body_.make_ms; }
  std::vector<RepresentationFact> facts() const override;
  bool names_faces() const override { return body_.normals == VoxelNormals::kExact; }
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;

 private:
  struct Shown {
    std::uint32_t placed_face = 0;
    Vec3 normal;
  };
  // The first voxel of a ray that a face touches that is not left out.
  VoxelHit WalkWithout(const std::vector<bool>& leave_out, const BoundWalk& walk, VoxelRay ray,
                       WalkCounters* counters) const;
  Shown ShownAt(const VoxelHit& hit, Vec3 direction) const;
  Vec3 NormalOf(const VoxelHit& hit, Vec3 direction) const;

  const Body body_;
  const VoxelModel& model_;
  const VoxelGrid& grid_;
};

Method VoxelMethod();

}  // namespace facetless
