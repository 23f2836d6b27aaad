// When a ray leaves a cube that it visits: two ways to find the least of the times at which it passes the three planes. Both
// give the same number, bit for bit.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/voxel_walks/voxel_ray.h"

namespace facetless {

// The least of the three.
class LeastExit {
 public:
  LeastExit(const VoxelRay& ray, int) : ray_(ray) {}
  double Leave(const VoxelPoint& low, int edge) const { return ray_.Leave(low, edge); }

 private:
  const VoxelRay& ray_;
};

// The axes are sorted once for a ray, by the size of the direction's components; P. Procházka (2013), section 6.12. A cube is
// probably left through the side across the largest component, so that this time is computed first, and accepted if the point
// there lies between the other sides. The point is rounded: it must lie inside by a margin, which is more than the rounding of
// the point and of the times moves it. Otherwise the next time is compared, and so on.
class SortedExit {
 public:
  SortedExit(const VoxelRay& ray, int root_level) : ray_(ray) {
    const Vec3 d = ray.direction(), o = ray.PointAt(0);
    const double direction[3] = {d.x, d.y, d.z}, origin[3] = {o.x, o.y, o.z};
    for (int i = 0; i < 3; ++i) {
      direction_[i] = direction[i];
      origin_[i] = origin[i];
    }
    const auto sort = [&](int a, int b) {
      if (std::abs(direction[axes_[a]]) < std::abs(direction[axes_[b]])) std::swap(axes_[a], axes_[b]);
    };
    sort(0, 1);
    sort(0, 2);
    sort(1, 2);
    // Each of a few operations rounds by at most 2⁻⁵³ of the largest coordinate.
    margin_ = std::ldexp(std::max(std::max(std::abs(o.x), std::abs(o.y)),
                                  std::max(std::abs(o.z), static_cast<double>(1 << root_level))),
                         -48);
  }

  double Leave(const VoxelPoint& low, int edge) const {
    const int lows[3] = {low.x, low.y, low.z};
    const int first = axes_[0], second = axes_[1], third = axes_[2];
    const double t = ray_.Leave(first, lows[first], lows[first] + edge);
    if (Inside(second, t, lows[second], edge) && Inside(third, t, lows[third], edge)) return t;
    const double next = std::min(t, ray_.Leave(second, lows[second], lows[second] + edge));
    return std::min(next, ray_.Leave(third, lows[third], lows[third] + edge));
  }

 private:
  bool Inside(int axis, double t, int low, int edge) const {
    const double at = origin_[axis] + t * direction_[axis];
    return at > low + margin_ && at < low + edge - margin_;
  }

  const VoxelRay& ray_;
  double origin_[3], direction_[3];
  int axes_[3] = {0, 1, 2};
  double margin_;
};

}  // namespace facetless
