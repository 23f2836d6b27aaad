// MeshRays: secondary rays (view/secondary_rays.h) on the triangles of a mesh, with Embree.
//
//     const MeshRays rays(scene);
//     rays.FindBlocked(starts, shadow_rays, passages);
//
//  1. A triangle cannot tell its own start from another intersection: float32 moves both. Starts are therefore lifted
//     off the surface along their normal, to the side of the ray, by lift_mm(), which is kLiftShare of the diagonal
//     of the mesh and at least kLiftNoises times the noise of its positions.
//  2. Lifted starts lose what lies within the lift, and where a facet lies above the smooth normal's horizon, rays that
//     should leave the surface meet their own mesh (the shadow terminator). Both are properties of meshes, and are
//     what `difference.light` measures.
//  3. Distances and points are computed again in double, from the placed corners (tracer.h, law 2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/baseline/tracer.h"
#include "render/view/secondary_rays.h"

namespace facetless {

class MeshRays final : public SecondaryRays {
 public:
  // What viewers and renderers commonly use: far above the resolution of float32, 2^-24.
  static constexpr double kLiftShare = 0x1p-16;
  static constexpr double kLiftNoises = 16;

  // `scene` must outlive the object.
  explicit MeshRays(const BaselineScene& scene);

  void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<RayPassage> passages) const override;
  void FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<SecondaryHit> hits) const override;

  std::string structure() const override { return "embree"; }
  double build_ms() const override { return 0; }      // it is the tree of the primary rays
  std::uint64_t bytes() const override { return 0; }  // as build_ms
  double lift_mm() const override { return lift_mm_; }

  // The start of a ray relative to the centre of the mesh, lifted to the side of the direction.
  Vec3 LiftedStart(const RayStart& start, Vec3 direction) const;

 private:
  const BaselineScene& scene_;
  double lift_mm_;
};

}  // namespace facetless
