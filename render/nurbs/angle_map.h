// The map between a span's native parameter and its Bézier parameter t ∈ [0,1] (SpanMap in
// render/model/model.h).
//
//  1. The map of kLinear is native = begin + t·(end − begin). The map of kHalfAngle, with m the centre and h
//     half the width of the span, is (2t − 1)·tan(h/2) = tan((native − m)/2).
//  2. Ends map to ends exactly, in both directions: begin ↔ 0, end ↔ 1.
//  3. The functions use base/trigonometry.h and give the same bits on every machine. Their errors are a few
//     units in the last place of the larger of |native| and the width of the span.
//  4. Arguments slightly outside the span extrapolate smoothly. kHalfAngle requires |native − m| < 3.
#pragma once

#include "render/model/model.h"

namespace facetless {

// The map of one span; the tangent of a quarter of its width is computed only once.
class SpanParameter {
 public:
  SpanParameter() = default;
  explicit SpanParameter(const Span& span);

  double ToBezier(double native) const;
  double ToNative(double t) const {
    if (tangent_ != 0) return AngleToNative(t);
    return t <= 0.5 ? begin_ + t * (end_ - begin_) : end_ - (1 - t) * (end_ - begin_);
  }
  // The first and second derivative of t with respect to the native parameter, at t.
  double Rate(double t) const {
    if (tangent_ == 0) return 1 / (end_ - begin_);
    const double w = (2 * t - 1) * tangent_;
    return (1 + w * w) / (4 * tangent_);
  }
  double RateOfRate(double t) const;

 private:
  double AngleToNative(double t) const;

  double begin_ = 0, end_ = 1;
  double tangent_ = 0;  // tan(h/2); 0 for a linear span
};

double NativeToBezier(const Span& span, double native);
double BezierToNative(const Span& span, double t);

}  // namespace facetless
