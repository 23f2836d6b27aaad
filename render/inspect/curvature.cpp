#include "render/inspect/curvature.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// The least extent of one direction, as a share of the other. At a share c from a pole, second derivatives
// cancel down to c² of their size. At this limit, the rounding error is 2^-53·2^40 of the curvature, which is
// barely visible as a colour.
constexpr double kLeastExtent = 0x1p-20;

// The second fundamental form in the basis of the frame, with the sign of law 1.
struct ShapeOperator {
  double first = 0, mixed = 0, second = 0;
};

ShapeOperator Shape(const SurfacePoint& p, const TangentFrame& f) {
  const double l = -Dot(p.duu, f.normal), m = -Dot(p.duv, f.normal), n = -Dot(p.dvv, f.normal);
  return {f.a * f.a * l, f.a * (f.b * l + f.c * m), f.b * f.b * l + 2 * f.b * f.c * m + f.c * f.c * n};
}

}  // namespace

SurfacePoint Placed(const SurfacePoint& point, const Placement& placement) {
  return {placement.Point(point.position), placement.Vector(point.du),  placement.Vector(point.dv),
          placement.Vector(point.duu),     placement.Vector(point.duv), placement.Vector(point.dvv)};
}

double OutwardSign(const Face& face, const Placement& placement) {
  return (face.reversed ? -1.0 : 1.0) * (placement.Determinant() < 0 ? -1.0 : 1.0);
}

std::optional<TangentFrame> FrameAt(const SurfacePoint& p, double outward, double extent_u, double extent_v) {
  const double length = Length(p.du), size = std::max(extent_u * length, extent_v * Length(p.dv));
  TangentFrame frame;
  frame.a = 1 / length;
  frame.first = frame.a * p.du;
  const double along = Dot(p.dv, frame.first);
  const Vec3 across = p.dv - along * frame.first;
  const double rest = Length(across);
  // Written in this form, the condition also treats NaN as degenerate.
  if (!(extent_u * length > kLeastExtent * size) || !(extent_v * rest > kLeastExtent * size) ||
      !std::isfinite(size))
    return std::nullopt;
  frame.c = 1 / rest;
  frame.b = -along * frame.a * frame.c;
  frame.second = frame.c * across;
  frame.normal = outward * Cross(frame.first, frame.second);
  return frame;
}

std::optional<Curvature> CurvatureAt(const SurfacePoint& point, double outward, double extent_u,
                                     double extent_v) {
  const std::optional<TangentFrame> frame = FrameAt(point, outward, extent_u, extent_v);
  if (!frame) return std::nullopt;
  const ShapeOperator s = Shape(point, *frame);
  const double middle = 0.5 * (s.first + s.second), half = 0.5 * (s.first - s.second);
  const double radius = std::sqrt(half * half + s.mixed * s.mixed);
  Curvature curvature{middle + radius, middle - radius, frame->first};
  if (!std::isfinite(curvature.max) || !std::isfinite(curvature.min)) return std::nullopt;
  // Compute the eigenvector from the row of the matrix without cancellation.
  const double x = half >= 0 ? radius + half : s.mixed, y = half >= 0 ? s.mixed : radius - half;
  if (x != 0 || y != 0) curvature.max_direction = Normalized(x * frame->first + y * frame->second);
  return curvature;
}

double NormalCurvature(const SurfacePoint& point, const TangentFrame& frame, Vec3 direction) {
  const ShapeOperator s = Shape(point, frame);
  const double x = Dot(direction, frame.first), y = Dot(direction, frame.second);
  return s.first * x * x + 2 * s.mixed * x * y + s.second * y * y;
}

}  // namespace facetless
