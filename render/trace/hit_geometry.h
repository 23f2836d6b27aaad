// The geometry of a hit: tangents, normal and depth at a root (s, t) of a leaf.
#pragma once

#include "render/base/vec.h"
#include "render/nurbs/leaf.h"
#include "render/view/camera.h"

namespace facetless {

struct HitGeometry {
  Vec3 ds,
      dt;  // derivatives of the surface point with respect to s and t, mm, in camera axes (right, down, forward)
  Vec3 normal;            // unit vector along ds × dt, model axes; (0,0,0) if it cannot be determined
  double depth = 0;       // mm along the view direction
  double cosine = 0;      // |normal · ray direction|
  bool singular = false;  // ds × dt vanishes within double precision
};

// Of the root (s, t) of the ray through (x, y) relative to the image centre. Where ds × dt vanishes (a pole,
// a collapsed edge) the normal is the one-sided limit towards the leaf's middle. `arithmetic` is that of the
// kernel that the leaf was made for.
HitGeometry EvaluateHit(const CertifiedLeaf& leaf, const KernelArithmetic& arithmetic, double s, double t,
                        double x, double y, const CameraFrame& frame);
HitGeometry EvaluateHit(const HardLeaf& leaf, double s, double t, double x, double y,
                        const CameraFrame& frame);
HitGeometry EvaluateHit(const SeamLeaf& leaf, double s, double t, double x, double y,
                        const CameraFrame& frame);

}  // namespace facetless
