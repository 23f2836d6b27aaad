#include "render/inspect/stripes.h"

#include <cmath>

#include "render/inspect/angle.h"

namespace facetless {
namespace {

// Lines farther away, in diagonals, lie closer together than any pixel resolves.
constexpr double kFarthest = 6;
// The share of a line in its period: lines on a ceiling, not stripes.
constexpr double kLineShare = 0.3;

Stripe Alternating(double stripes) {
  const double half = 0.5 * std::floor(stripes);
  return half == std::floor(half) ? Stripe::kLight : Stripe::kDark;
}

}  // namespace

StripePattern::StripePattern(const Inspection& inspection, const CameraFrame& frame, const Box3& bounds)
    : kind_(inspection.kind),
      count_(inspection.count),
      direction_(Resolved(inspection.direction, frame)),
      plane_(Resolved(inspection.plane, frame)),
      across_(Normalized(Cross(plane_, direction_))),
      center_(bounds.center()),
      diagonal_(bounds.diagonal()) {}

Stripe StripePattern::At(Vec3 position, Vec3 normal, Vec3 toward) const {
  if (kind_ == InspectionKind::kIsophotes) return Alternating(0.5 * count_ * (Dot(normal, direction_) + 1));
  // Mirror the ray to the eye at the normal.
  const Vec3 mirrored = 2 * Dot(normal, toward) * normal - toward;
  if (kind_ == InspectionKind::kReflection) return AtReflection(position, mirrored);
  return Alternating(count_ * (AngleDeg(mirrored, direction_) / 180));
}

Stripe StripePattern::AtReflection(Vec3 position, Vec3 mirrored) const {
  const double rise = Dot(mirrored, plane_);
  if (!(rise > 0)) return Stripe::kNone;
  const Vec3 from_center = position - center_;
  const Vec3 meets = from_center + ((diagonal_ - Dot(from_center, plane_)) / rise) * mirrored;
  const Vec3 in_plane = meets - Dot(meets, plane_) * plane_;
  if (!(Length(in_plane) <= kFarthest * diagonal_)) return Stripe::kNone;
  const double lines = count_ * Dot(meets, across_) / diagonal_;
  return lines - std::floor(lines) < kLineShare ? Stripe::kLight : Stripe::kDark;
}

}  // namespace facetless
