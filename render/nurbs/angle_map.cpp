#include "render/nurbs/angle_map.h"

#include "render/base/trigonometry.h"

namespace facetless {
namespace {

double LinearToBezier(double begin, double end, double native) {
  const double from_begin = native - begin, to_end = end - native, width = end - begin;
  return from_begin <= to_end ? from_begin / width : 1 - to_end / width;
}

}  // namespace

SpanParameter::SpanParameter(const Span& span)
    : begin_(span.begin),
      end_(span.end),
      tangent_(span.map == SpanMap::kHalfAngle ? PolyTan(0.25 * (span.end - span.begin)) : 0) {}

double SpanParameter::ToBezier(double native) const {
  if (tangent_ == 0) return LinearToBezier(begin_, end_, native);
  // With s measured from the nearer end and q = tan(δ/2) of the angle δ from there: s = q·(1 + T²) / (2T·(1 +
  // qT)).
  const double from_begin = native - begin_, to_end = end_ - native;
  const double q = PolyTan(0.5 * (from_begin <= to_end ? from_begin : to_end));
  const double s = q * (1 + tangent_ * tangent_) / (2 * tangent_ * (1 + q * tangent_));
  return from_begin <= to_end ? s : 1 - s;
}

double SpanParameter::AngleToNative(double t) const {
  // The inverse of the same formula: q = 2sT / (1 + T² − 2sT²).
  const double s = t <= 0.5 ? t : 1 - t;
  const double q = 2 * s * tangent_ / (1 + tangent_ * tangent_ - 2 * s * tangent_ * tangent_);
  const double angle = 2 * PolyAtan(q);
  return t <= 0.5 ? begin_ + angle : end_ - angle;
}

double SpanParameter::RateOfRate(double t) const {
  return tangent_ == 0 ? 0 : (2 * t - 1) * tangent_ * Rate(t);
}

double NativeToBezier(const Span& span, double native) {
  return SpanParameter(span).ToBezier(native);
}

double BezierToNative(const Span& span, double t) {
  return SpanParameter(span).ToNative(t);
}

}  // namespace facetless
