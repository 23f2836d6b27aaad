#include "render/view/projection.h"

#include <cmath>

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// Rounding in units of roundoff. An axis is a normalised cross product, transformed by the placement and
// divided by the pixel size, and its dot product adds three products. Placing the eye subtracts a translation
// and adds three products.
constexpr double kAxisUnits = 16, kPlacingUnits = 8;

// Applies the transposed linear part of the placement to a camera axis, which gives the axis in part
// coordinates.
Vec3 Pull(const Placement& placement, Vec3 axis) {
  const auto& m = placement.m;
  return {m[0][0] * axis.x + m[1][0] * axis.y + m[2][0] * axis.z,
          m[0][1] * axis.x + m[1][1] * axis.y + m[2][1] * axis.z,
          m[0][2] * axis.x + m[1][2] * axis.y + m[2][2] * axis.z};
}

}  // namespace

ViewProjection::ViewProjection(const CameraFrame& frame, const Placement& placement)
    : right_((1 / frame.pixel_x) * Pull(placement, frame.right)),
      down_((1 / frame.pixel_y) * Pull(placement, frame.down)),
      forward_(Pull(placement, frame.forward)),
      perspective_(frame.projection == Projection::kPerspective) {
  // Compute the eye in part coordinates (exact for a rigid placement), and the remainder. Both are relative
  // to the position of the part, so a part far from the origin loses no precision if the eye is near it.
  const Vec3 translation{placement.m[0][3], placement.m[1][3], placement.m[2][3]};
  const Vec3 eye = frame.eye - translation;
  origin_ = Pull(placement, eye);
  const Vec3 rest = placement.Vector(origin_) - eye;
  x_ = Dot(rest, frame.right) / frame.pixel_x;
  y_ = Dot(rest, frame.down) / frame.pixel_y;
  z_ = Dot(rest, frame.forward);

  // Bound the rounding of the placement; the identity does not round.
  const auto size = [](Vec3 v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); };
  origin_size_ = size(origin_);
  if (size(rest) > 0 || size(translation) > 0)
    placed_error_ = kPlacingUnits * kEpsilon * (size(eye) + origin_size_);
  scale_ = {Length(right_), Length(down_), Length(forward_)};
}

ViewProjection::Point ViewProjection::Error(Vec4 p) const {
  const double d =
      std::fabs(p.x - p.w * origin_.x) + std::fabs(p.y - p.w * origin_.y) + std::fabs(p.z - p.w * origin_.z);
  // p.w·origin is exact if p.w is 1.
  const double error =
      kEpsilon * (kAxisUnits * d + (p.w == 1 ? 0 : p.w * origin_size_)) + p.w * placed_error_;
  const double x = scale_.x * error, y = scale_.y * error, z = scale_.z * error;
  return perspective_ ? Point{x, y, z, 0} : Point{x, y, 0, z};
}

ViewProjection::Point ViewProjection::operator()(Vec4 p) const {
  const Vec3 d{p.x - p.w * origin_.x, p.y - p.w * origin_.y, p.z - p.w * origin_.z};
  const double x = Dot(right_, d) + x_ * p.w;
  const double y = Dot(down_, d) + y_ * p.w;
  const double z = Dot(forward_, d) + z_ * p.w;
  return perspective_ ? Point{x, y, z, p.w} : Point{x, y, p.w, z};
}

}  // namespace facetless
