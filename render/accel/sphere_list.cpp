#include "render/accel/sphere_list.h"

#include <cmath>

namespace facetless {
namespace {

// The vector across the ray has an error of a few roundings of the distance, which is at most 2^11 sizes of
// the scene (BoxSet::TooFar): 16 · 2^-53 · 2^11 sizes.
constexpr double kSphereMargin = 0x1p-38;

}  // namespace

double SphereMargin(const BoxSet& boxes) {
  return kSphereMargin * boxes.scale();
}

BoundingSphere SphereAround(const SlabBox& box, double margin) {
  BoundingSphere sphere;
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sphere.centre[axis] = 0.5 * box.side[0][axis] + 0.5 * box.side[1][axis];
    // The centre is rounded: take the farther side.
    const double half =
        std::max(box.side[1][axis] - sphere.centre[axis], sphere.centre[axis] - box.side[0][axis]);
    square += half * half;
  }
  sphere.radius = std::sqrt(square) + margin;
  return sphere;
}

SphereRay::SphereRay(const SlabRay& ray) {
  double square = 0;
  for (const double component : ray.direction) square += component * component;
  inverse_square = 1 / square;
  inverse_length = 1 / std::sqrt(square);
}

SphereList::SphereList(std::span<const Box3> boxes) : boxes_(boxes) {
  const double margin = SphereMargin(boxes_);
  spheres_.reserve(boxes_.size());
  for (const SlabBox& box : boxes_.boxes()) spheres_.push_back(SphereAround(box, margin));
}

}  // namespace facetless
