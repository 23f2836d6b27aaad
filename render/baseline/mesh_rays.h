// MeshRays: secondary rays (view/secondary_rays.h) on the triangles of a mesh, with Embree.
//
//     const MeshRays rays(scene);
//     rays.FindBlocked(starts, shadow_rays, passages);
//
//  1. In float32, the start of a ray cannot be told from an intersection near it, because both are rounded. Starts are
//     therefore lifted off the surface along their normal, to the side to which the ray goes, by lift_mm(). This is
//     kLiftShare of the diagonal of the mesh, and at least kLiftNoises times the noise of its positions.
//  2. Surfaces within the lift of a start are not found. Where the interpolated normal faces the light and the facet
//     does not, rays that should leave the surface meet the mesh from which they start (the shadow terminator). Both
//     faults are properties of meshes, and `difference.light` in the report measures them.
//  3. Points, and their distances from the start before it was lifted, are computed again in double, from the placed
//     corners (tracer.h, law 2).
//  4. No answer is certified, and none has a doubt.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/baseline/tracer.h"
#include "render/view/secondary_rays.h"

namespace facetless {

class MeshRays final : public SecondaryRays {
 public:
  // Law 1. The share is of the size that renderers commonly use, and far above the resolution of float32, 2^-24.
  static constexpr double kLiftShare = 0x1p-16;
  static constexpr double kLiftNoises = 16;

  // `scene` must outlive the object.
  explicit MeshRays(const BaselineScene& scene);

  void FindBlocked(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<RayPassage> passages) const override;
  void FindNearest(std::span<const RayStart> starts, std::span<const SecondaryRay> rays,
                   std::span<SecondaryHit> hits) const override;

  std::string structure() const override { return "embree"; }
  // The tree is that of the primary rays, so it takes no further time and memory.
  double build_ms() const override { return 0; }
  std::uint64_t bytes() const override { return 0; }
  double lift_mm() const override { return lift_mm_; }

  // Returns the start of a ray relative to the centre of the mesh, lifted to the side to which the direction points.
  Vec3 LiftedStart(const RayStart& start, Vec3 direction) const;

 private:
  const BaselineScene& scene_;
  double lift_mm_;
};

}  // namespace facetless
