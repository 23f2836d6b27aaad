#include "render/inspect/angle.h"

#include <cmath>
#include <numbers>

#include "render/base/trigonometry.h"

namespace facetless {

double AngleDeg(Vec3 a, Vec3 b) {
  // Kahan's formula: |a − b| and |a + b| are twice the sine and the cosine of half the angle.
  const double sum = Length(a + b);
  if (!(sum > 0)) return 180;
  return 2 * PolyAtan(Length(a - b) / sum) * (180 / std::numbers::pi);
}

double DraftDeg(Vec3 normal, Vec3 pull) {
  return 90 - AngleDeg(normal, pull);
}

double TurnDeg(Vec2 v) {
  const double length = Length(v);
  // Use tan(θ/2) = y / (r + x) = (r − x) / y, in the form without cancellation.
  if (v.x >= 0 && length > 0) return 2 * PolyAtan(v.y / (length + v.x)) * (180 / std::numbers::pi);
  if (v.y == 0) return 180;
  return 2 * PolyAtan((length - v.x) / v.y) * (180 / std::numbers::pi);
}

double SineOfDeg(double degrees) {
  const double t = PolyTan(0.5 * degrees * (std::numbers::pi / 180));
  return 2 * t / (1 + t * t);
}

}  // namespace facetless
