#include "render/trace/projection.h"

namespace facetless {
namespace {

// The placement's linear part, transposed, applied to a camera axis: the axis in part coordinates.
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
  // The eye in part coordinates (exactly so for a rigid placement), and what that leaves over.
  const Vec3 translation{placement.m[0][3], placement.m[1][3], placement.m[2][3]};
  origin_ = Pull(placement, frame.eye - translation);
  const Vec3 rest = placement.Point(origin_) - frame.eye;
  x_ = Dot(rest, frame.right) / frame.pixel_x;
  y_ = Dot(rest, frame.down) / frame.pixel_y;
  z_ = Dot(rest, frame.forward);
}

ViewProjection::Point ViewProjection::operator()(Vec4 p) const {
  const Vec3 d{p.x - p.w * origin_.x, p.y - p.w * origin_.y, p.z - p.w * origin_.z};
  const double x = Dot(right_, d) + x_ * p.w;
  const double y = Dot(down_, d) + y_ * p.w;
  const double z = Dot(forward_, d) + z_ * p.w;
  return perspective_ ? Point{x, y, z, p.w} : Point{x, y, p.w, z};
}

}  // namespace facetless
