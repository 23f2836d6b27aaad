// Position and derivatives of a surface at native parameters (u,v), from its grid of Bézier patches.
//
//  1. Derivatives are with respect to *native* parameters: an angle stays an angle, across all patches.
//  2. Outside the grid the border patch is extrapolated. On the border of two patches the one with the larger
//     index answers.
//  3. Scalar, without allocation and without libm: the same bits on every machine. Not for the inner loop of
//     the tracer.
//  4. Where a weight sum vanishes (only possible by extrapolation) the result isn't finite; the caller
//     checks.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/angle_map.h"

namespace facetless {

struct SurfacePoint {
  Vec3 position;       // mm, in the part's own coordinates
  Vec3 du, dv;         // mm per native unit
  Vec3 duu, duv, dvv;  // zero if not asked for
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
  // The largest coordinate of a control point, mm: what a surface point's rounding is relative to.
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
