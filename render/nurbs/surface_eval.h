// Position and derivatives of a surface at native parameters (u,v), evaluated from its grid of Bézier
// patches.
//
//     const SurfaceEval surface(model, model.faces[face].surface);
//     const SurfacePoint point = surface.First(u, v);
//     const Vec3 normal = Normalized(Cross(point.du, point.dv));
//
//  1. Derivatives are with respect to *native* parameters: an angle stays an angle, across all patches.
//  2. Outside the grid, the border patch is extrapolated. On the border between two patches, the patch with
//     the larger index is evaluated.
//  3. The code is scalar, allocates nothing and does not use libm: it gives the same bits on every machine.
//     It is not fast enough for the inner loop of the tracer.
//  4. If the weight at a point vanishes, which only extrapolation can cause, the result is not finite. The
//     caller must check for that.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/angle_map.h"

namespace facetless {

struct SurfacePoint {
  Vec3 position;       // mm, in the part's own coordinates
  Vec3 du, dv;         // mm per native unit
  Vec3 duu, duv, dvv;  // mm per squared native unit; zero unless Second computed them
};

class SurfaceEval {
 public:
  // `model` must outlive the evaluator; surface < model.surfaces.size().
  SurfaceEval(const Model& model, std::uint32_t surface);

  Vec3 Position(double u, double v) const;
  SurfacePoint First(double u, double v) const;
  SurfacePoint Second(double u, double v) const;

  // The grid's native rectangle.
  double u_begin() const { return u_knots_.front(); }
  double u_end() const { return u_knots_.back(); }
  double v_begin() const { return v_knots_.front(); }
  double v_end() const { return v_knots_.back(); }
  // The largest coordinate of a control point, mm. Rounding errors of surface points are relative to it.
  double magnitude() const { return magnitude_; }

 private:
  SurfacePoint Evaluate(double u, double v, int order) const;

  const Model* model_;
  Surface surface_;
  std::vector<double> u_knots_, v_knots_;
  std::vector<SpanParameter> u_maps_, v_maps_;
  double magnitude_ = 0;
};

}  // namespace facetless
