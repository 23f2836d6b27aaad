#include "render/inspect/stripes.h"

#include <cmath>

#include "render/inspect/angle.h"

namespace facetless {
namespace {

// Beyond this distance along the tunnel, in diagonals, lines are closer together than pixels can resolve.
constexpr double kFarthest = 10;
// The share of a lamp in its period.
constexpr double kLineShare = 0.4;
// The borders of stripes are shifted by this share of a stripe. Otherwise, planes along an axis would lie
// exactly on a border, and rounding would decide their colour.
constexpr double kShift = 0.25;

Stripe Alternating(double stripes) {
  const double half = 0.5 * std::floor(stripes + kShift);
  return half == std::floor(half) ? Stripe::kLight : Stripe::kDark;
}

// A unit vector perpendicular to the unit vector `v`, chosen by its smallest coordinate.
Vec3 Perpendicular(Vec3 v) {
  const Vec3 size{std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)};
  const Vec3 helper = size.z <= size.x && size.z <= size.y ? Vec3{0, 0, 1}
                      : size.y <= size.x                   ? Vec3{0, 1, 0}
                                                           : Vec3{1, 0, 0};
  return Normalized(Cross(v, helper));
}

}  // namespace

StripePattern::StripePattern(const Inspection& inspection, const CameraFrame& frame, const Box3& bounds)
    : kind_(inspection.kind),
      count_(inspection.count),
      direction_(Resolved(inspection.direction, frame)),
      across_(Perpendicular(direction_)),
      above_(Cross(direction_, across_)),
      center_(bounds.center()),
      diagonal_(bounds.diagonal()) {}

Stripe StripePattern::At(Vec3 position, Vec3 normal, Vec3 toward) const {
  if (kind_ == InspectionKind::kIsophotes) return Alternating(0.5 * count_ * (Dot(normal, direction_) + 1));
  // Reflect the direction to the eye at the normal.
  const Vec3 mirrored = 2 * Dot(normal, toward) * normal - toward;
  if (kind_ == InspectionKind::kReflection) return AtReflection(position, mirrored);
  return Alternating(count_ * (AngleDeg(mirrored, direction_) / 180));
}

Stripe StripePattern::AtReflection(Vec3 position, Vec3 mirrored) const {
  // Find the point where the ray meets the circle in the plane across the tunnel, from inside: |p + t·r| =
  // radius.
  const Vec3 from_center = position - center_;
  const Vec2 p{Dot(from_center, across_), Dot(from_center, above_)},
      r{Dot(mirrored, across_), Dot(mirrored, above_)};
  const double square = Dot(r, r), half = Dot(p, r), rest = diagonal_ * diagonal_ - Dot(p, p);
  const double t = (std::sqrt(half * half + square * rest) - half) / square;
  if (!(std::fabs(Dot(from_center + t * mirrored, direction_)) <= kFarthest * diagonal_))
    return Stripe::kNone;
  const double lines = count_ * (TurnDeg(p + t * r) / 360) + kShift;
  return lines - std::floor(lines) < kLineShare ? Stripe::kLight : Stripe::kDark;
}

}  // namespace facetless
