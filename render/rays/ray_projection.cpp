#include "render/rays/ray_projection.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

constexpr double kEpsilon = 0x1p-53;
// Rounding in units of roundoff, as in view/projection.cpp: an axis is a normalised cross product, taken to the part's
// coordinates, and its dot product adds three products.
constexpr double kAxisUnits = 16, kPlacingUnits = 12;

// The difference a − b in two parts: the rounded one, and exactly what is missing from it (D. Knuth).
struct Difference {
  double value, missing;
};

Difference Subtract(double a, double b) {
  const double value = a - b;
  const double of_b = a - value, of_a = value + of_b;
  return {value, (a - of_a) + (of_b - b)};
}

struct Difference3 {
  Vec3 value, missing;
};

Difference3 Subtract(Vec3 a, Vec3 b) {
  const Difference x = Subtract(a.x, b.x), y = Subtract(a.y, b.y), z = Subtract(a.z, b.z);
  return {{x.value, y.value, z.value}, {x.missing, y.missing, z.missing}};
}

double Size(Vec3 v) {
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

// The transposed linear part, applied to a direction of the model: a row of the product of a projection with the
// placement.
Vec3 Pull(const Placement& placement, Vec3 axis) {
  const auto& m = placement.m;
  return {m[0][0] * axis.x + m[1][0] * axis.y + m[2][0] * axis.z,
          m[0][1] * axis.x + m[1][1] * axis.y + m[2][1] * axis.z,
          m[0][2] * axis.x + m[1][2] * axis.y + m[2][2] * axis.z};
}

// The largest size of a placed vector of size 1.
double Growth(const Placement& placement) {
  double growth = 0;
  for (int column = 0; column < 3; ++column)
    growth = std::max(growth, std::fabs(placement.m[0][column]) + std::fabs(placement.m[1][column]) +
                                  std::fabs(placement.m[2][column]));
  return growth;
}

}  // namespace

PlacedPart::PlacedPart(const Placement& placement) : placement_(placement) {
  const auto& m = placement.m;
  const Vec3 x{m[0][0], m[1][0], m[2][0]}, y{m[0][1], m[1][1], m[2][1]}, z{m[0][2], m[1][2], m[2][2]};
  const double determinant = Dot(x, Cross(y, z));
  const Vec3 rows[3] = {(1 / determinant) * Cross(y, z), (1 / determinant) * Cross(z, x),
                        (1 / determinant) * Cross(x, y)};
  for (int r = 0; r < 3; ++r) {
    inverse_.m[r][0] = rows[r].x;
    inverse_.m[r][1] = rows[r].y;
    inverse_.m[r][2] = rows[r].z;
    inverse_.m[r][3] = 0;
    for (int c = 0; c < 3; ++c) shifted_only_ = shifted_only_ && m[r][c] == (r == c ? 1 : 0);
  }
  outward_ = determinant < 0 ? -1 : 1;
}

double PixelOf(double diagonal_mm) {
  // The power of two below a 1024th of the diagonal.
  int exponent = 0;
  std::frexp(diagonal_mm, &exponent);
  return diagonal_mm > 0 ? std::ldexp(1.0, std::max(exponent - 11, -900)) : 1;
}

RayFrame::RayFrame(Vec3 origin, Vec3 direction, double pixel) {
  camera.pixel_x = camera.pixel_y = pixel;
  // The axis of the smallest component is farthest from the ray.
  const Vec3 size{std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)};
  const Vec3 helper = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                      : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                           : Vec3{0, 0, 1};
  camera.eye = origin;
  camera.forward = direction;
  camera.right = Normalized(Cross(direction, helper));
  camera.down = Cross(direction, camera.right);
}

RayProjection::RayProjection(const RayFrame& ray, const PlacedPart& part)
    : right_(ray.camera.right),
      down_(ray.camera.down),
      forward_(ray.camera.forward),
      axes_{ray.camera.right, ray.camera.down, ray.camera.forward},
      part_(&part),
      pixels_per_mm_(1 / ray.camera.pixel_x) {
  const Placement& placement = part.placement();
  const Difference3 moved =
      Subtract(ray.camera.eye, {placement.m[0][3], placement.m[1][3], placement.m[2][3]});
  start_ = moved.value;
  lost_ = moved.missing;
  if (!part.shifted_only()) {
    right_ = Pull(placement, right_);
    down_ = Pull(placement, down_);
    forward_ = Pull(placement, forward_);
    start_ = part.inverse().Vector(moved.value);
    rest_ = placement.Vector(start_) - moved.value;
    placed_error_ = kPlacingUnits * kEpsilon * (Size(moved.value) + Growth(placement) * Size(start_));
  }
  scale_ = {pixels_per_mm_ * Length(right_), pixels_per_mm_ * Length(down_), Length(forward_)};
  right_ = pixels_per_mm_ * right_;
  down_ = pixels_per_mm_ * down_;
}

void RayProjection::Project(const SpacePiece& piece, bool rational, Vec3 face_origin, BezierNet* net) const {
  // The start relative to the face. A point P of the piece is at A·(P − start) + rest from the ray's start.
  const Difference3 local = Subtract(start_, face_origin);
  const Vec3 start = local.value;
  const Vec3 rest =
      rest_ - lost_ - (part_->shifted_only() ? local.missing : part_->placement().Vector(local.missing));
  const double x = pixels_per_mm_ * Dot(axes_[0], rest), y = pixels_per_mm_ * Dot(axes_[1], rest),
               z = Dot(axes_[2], rest);

  double largest = 0, weight = 0;
  for (int i = 0; i < net->points(); ++i) {
    const double* const p = piece.net + kNetComponents * i;
    const double w = p[kW];
    const Vec3 d{std::fma(-w, start.x, p[kX]), std::fma(-w, start.y, p[kY]), std::fma(-w, start.z, p[kQ])};
    net->at(i, kX) = Dot(right_, d) + x * w;
    net->at(i, kY) = Dot(down_, d) + y * w;
    net->at(i, kW) = w;
    net->at(i, kQ) = Dot(forward_, d) + z * w;
    largest = std::max(largest, Size(d));
    weight = std::max(weight, w);
  }
  // The axes and the dot products; the placement of the start; the error of the piece itself, where an error of the
  // weight acts at the start's distance.
  const double of_weight = rational ? piece.error[kW] : 0;
  const double own = piece.error[kX] + piece.error[kY] + piece.error[kQ] + Size(start) * of_weight;
  const double error = kAxisUnits * kEpsilon * (largest + weight * Size(rest)) + own;
  net->error[kX] = scale_.x * error + weight * placed_error_ * pixels_per_mm_;
  net->error[kY] = scale_.y * error + weight * placed_error_ * pixels_per_mm_;
  net->error[kW] = of_weight;
  net->error[kQ] = scale_.z * error + weight * placed_error_;
}

}  // namespace facetless
