#include "render/shade/hemisphere.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Cosine and sine of the golden angle, π·(3 − √5), and of a sixteenth of a turn.
constexpr Vec2 kGoldenTurn = {-0.73736887807831985, 0.67549029426152362};
constexpr Vec2 kSixteenth = {0.92387953251128674, 0.38268343236508977};
// Bayer's matrix: the order of the sixteen sets within a block of 4 × 4 samples, chosen so that the sets of neighbours
// differ much.
constexpr int kOrder[Hemisphere::kSets] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};

// Turns a unit vector, and normalises the result.
Vec2 Turned(Vec2 v, Vec2 turn) {
  const Vec2 turned{v.x * turn.x - v.y * turn.y, v.x * turn.y + v.y * turn.x};
  return 1 / Length(turned) * turned;
}

}  // namespace

Hemisphere::Hemisphere(int count) : count_(static_cast<std::size_t>(count)) {
  directions_.reserve(count_ * kSets);
  for (const int order : kOrder) {
    Vec2 angle{1, 0};
    for (int i = 0; i < order; ++i) angle = Turned(angle, kSixteenth);
    const double offset = (order + 0.5) / kSets;
    for (int i = 0; i < count; ++i) {
      const double square = (i + offset) / count;  // of the distance from the centre of the disc
      const double radius = std::sqrt(square);
      directions_.push_back({radius * angle.x, radius * angle.y, std::sqrt(std::max(0.0, 1 - square))});
      angle = Turned(angle, kGoldenTurn);
    }
  }
}

LocalFrame::LocalFrame(Vec3 axis) : z(axis) {
  const double sign = std::copysign(1.0, axis.z);
  const double a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
  x = {1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
  y = {b, sign + axis.y * axis.y * a, -axis.y};
}

}  // namespace facetless
