// The map between a span's native parameter and its Bézier parameter t ∈ [0,1] (SpanMap in
// render/model/model.h).
//
//  1. kLinear: native = begin + t·(end − begin). kHalfAngle, with m the centre and h half the width of the
//     span: (2t − 1)·tan(h/2) = tan((native − m)/2).
//  2. Ends map to ends exactly, in both directions: begin ↔ 0, end ↔ 1.
//  3. Trigonometry is that of base/trigonometry.h: the same bits on every machine. Errors are a few units in
//     the last place of the larger of |native| and the span's width.
//  4. Arguments slightly outside the span extrapolate smoothly. Require |native − m| < 3 for kHalfAngle.
#pragma once

#include "render/model/model.h"

namespace facetless {

// A span made ready: the tangent of the quarter width is computed once.
class SpanParameter {
 public:
  SpanParameter() = default;
  explicit SpanParameter(const Span& span);

  double ToBezier(double native) const;
  double ToNative(double t) const;
  // First and second derivative of t by the native parameter, at t.
  double Rate(double t) const;
  double RateOfRate(double t) const;

 private:
  double begin_ = 0, end_ = 1;
  double tangent_ = 0;  // tan(h/2); 0: linear
};

double NativeToBezier(const Span& span, double native);
double BezierToNative(const Span& span, double t);

}  // namespace facetless
