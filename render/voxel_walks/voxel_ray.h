// VoxelRay: a ray through the voxels of a model, prepared for walks.
//
//     VoxelRay ray;
//     if (!ray.Enter(origin, direction, 0, model.size())) return {};  // in the coordinates of the model; a miss
//     VoxelPoint cell = ray.CellAt(ray.t_first());
//
//  1. The ray passes the plane at p of an axis at t = Pass(axis, p) = (p − o)·(1/d), which is monotone in p even after
//     rounding. All walks decide by these numbers alone, so that all of them visit the same voxels.
//  2. At t, the ray is in the voxel whose lower plane it has passed at or before t, and whose upper plane it passes after t,
//     on every axis. So each t between the first and the last belongs to exactly one voxel, and voxels that the ray only
//     touches are not visited. Along an axis without a component of the direction, the ray stays in the voxel of its origin.
//  3. A hit is the first visited voxel that is filled, at the t at which the ray enters it.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/base/vec.h"
#include "render/voxels/voxel_model.h"

namespace facetless {

struct VoxelHit {
  double t = INFINITY;  // infinite: nothing was hit
  VoxelPoint at;        // the voxel
  Voxel voxel;          // its value; of a level above 0, the mean
  int side = -1;        // the side that was entered: 0, 1, 2 for x, y, z; −1: the ray began in the voxel
  int level = 0;        // the hit is a cube of 2^level voxels on a side
  bool hit() const { return t < INFINITY; }
};

// A ray in coordinates that are negated along each axis on which the ray descends, so that it ascends along all axes. Passing
// a plane has the same t, bit for bit: (−p − −o)·(−1/d) = (p − o)·(1/d), because negation does not round. Along an axis
// without a component, the origin is the centre of the voxel and the inverse is infinite, so that planes are passed at −∞ or ∞.
// Walks use it where they would branch on signs.
struct AscendingRay {
  double origin[3], inverse[3];
  unsigned descends;  // the axes that are negated, a bit each
  // The t at which the ray passes the plane at p, in these coordinates.
  double Pass(int axis, double p) const { return (p - origin[axis]) * inverse[axis]; }
};

class VoxelRay {
 public:
  // Prepares a ray, and clips it to the model. Returns false if it misses the model, or if it is not finite.
  bool Enter(Vec3 origin, Vec3 direction, double t_first, VoxelPoint size) {
    const double o[3] = {origin.x, origin.y, origin.z}, d[3] = {direction.x, direction.y, direction.z};
    const int n[3] = {size.x, size.y, size.z};
    t_first_ = t_first;
    t_last_ = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(o[axis]) || !std::isfinite(d[axis])) return false;
      origin_[axis] = o[axis];
      direction_[axis] = d[axis];
      inverse_[axis] = 1 / d[axis];
      // A component whose inverse is not finite is so small that it counts as 0.
      sign_[axis] = !std::isfinite(inverse_[axis]) ? 0 : d[axis] > 0 ? 1 : -1;
      if (sign_[axis] == 0) {
        if (!(o[axis] >= 0 && o[axis] < n[axis])) return false;
        origin_[axis] = static_cast<int>(o[axis]) + 0.5;
        direction_[axis] = 0;
        inverse_[axis] = INFINITY;
        continue;
      }
      const double low = Pass(axis, 0), high = Pass(axis, n[axis]);
      t_first_ = std::max(t_first_, std::min(low, high));
      t_last_ = std::min(t_last_, std::max(low, high));
    }
    return t_first_ < t_last_ && t_first_ < INFINITY;
  }

  // Begins the ray at t, or later. Returns false if nothing of it is left.
  bool BeginAt(double t) {
    t_first_ = std::max(t_first_, t);
    return t_first_ < t_last_;
  }
  // Ends the ray at t, or before. Returns false if nothing of it is left.
  bool EndAt(double t) {
    t_last_ = std::min(t_last_, t);
    return t_first_ < t_last_;
  }

  double t_first() const { return t_first_; }
  double t_last() const { return t_last_; }  // infinite only if the direction is zero
  int sign(int axis) const { return sign_[axis]; }
  // Components that count as 0 are 0.
  Vec3 direction() const { return {direction_[0], direction_[1], direction_[2]}; }
  // Rounded; walks that are exact decide by planes.
  Vec3 PointAt(double t) const {
    return {origin_[0] + t * direction_[0], origin_[1] + t * direction_[1], origin_[2] + t * direction_[2]};
  }
  double Pass(int axis, int plane) const { return (plane - origin_[axis]) * inverse_[axis]; }

  // Whether the ray is above the plane at t: in the voxel whose lower plane it is, or beyond.
  bool IsAbove(int axis, int plane, double t) const { return (Pass(axis, plane) <= t) == (sign_[axis] >= 0); }
  // When the ray leaves the interval of planes low … high of an axis, in which it is; infinite without a component along it.
  double Leave(int axis, int low, int high) const { return Pass(axis, sign_[axis] >= 0 ? high : low); }
  double Leave(const VoxelPoint& low, int edge) const {
    return std::min(std::min(Leave(0, low.x, low.x + edge), Leave(1, low.y, low.y + edge)),
                    Leave(2, low.z, low.z + edge));
  }
  // When the ray enters a cube that it visits; at the earliest t_first.
  double EnterAt(const VoxelPoint& low, int edge) const {
    const auto enter = [&](int axis, int at) { return Pass(axis, sign_[axis] >= 0 ? at : at + edge); };
    return std::max(std::max(t_first_, enter(0, low.x)), std::max(enter(1, low.y), enter(2, low.z)));
  }
  // The index along an axis at t. The guess is mostly right, or one off.
  int IndexAt(int axis, double t, int guess) const {
    if (IsAbove(axis, guess, t) && !IsAbove(axis, guess + 1, t)) return guess;
    int low = -1, high = kMostVoxelsPerAxis + 1;  // the index lies in low … high − 1
    for (int step = 1; low + 1 < high; step *= 2) {
      const int at = std::clamp(guess, low + 1, high - 1);
      (IsAbove(axis, at, t) ? low : high) = at;
      if (low + 1 < high) guess = low == at ? at + step : at - step;
    }
    return low;
  }
  // The voxel at t. Requires t_first() ≤ t < t_last().
  VoxelPoint CellAt(double t) const {
    const auto index = [&](int axis) {
      return IndexAt(axis, t,
                     static_cast<int>(std::clamp(t * direction_[axis] + origin_[axis], 0.0, kMostIndex)));
    };
    return {index(0), index(1), index(2)};
  }
  AscendingRay Ascending() const {
    AscendingRay ray;
    ray.descends = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const bool descends = sign_[axis] < 0;
      ray.origin[axis] = descends ? -origin_[axis] : origin_[axis];
      ray.inverse[axis] = descends ? -inverse_[axis] : inverse_[axis];
      ray.descends |= static_cast<unsigned>(descends) << axis;
    }
    return ray;
  }
  // The hit of a voxel, or a cube, that the ray enters at t.
  VoxelHit HitAt(double t, Voxel voxel, int level) const { return HitAt(t, voxel, level, CellAt(t)); }
  // The same, if the voxel at t is known.
  VoxelHit HitAt(double t, Voxel voxel, int level, VoxelPoint at) const {
    VoxelHit hit;
    hit.t = t;
    hit.at = at;
    hit.voxel = voxel;
    hit.level = level;
    const int corner[3] = {at.x >> level << level, at.y >> level << level, at.z >> level << level};
    for (int axis = 2; axis >= 0; --axis)
      if (Pass(axis, sign_[axis] >= 0 ? corner[axis] : corner[axis] + (1 << level)) == t) hit.side = axis;
    return hit;
  }

 private:
  static constexpr double kMostIndex = kMostVoxelsPerAxis;

  double origin_[3], direction_[3], inverse_[3];
  int sign_[3];  // of the direction; 0: no component along the axis
  double t_first_ = 0, t_last_ = 0;
};

}  // namespace facetless
