// An octree (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der Schnittpunktberechnung", section
// "Octree"): the box of the scene is halved on all three axes at once, again and again, and each leaf lists
// the objects that reach into it.
//
//     const Octree octree(boxes);
//     QueryState state(octree.state_size());
//     octree.Visit({origin, direction}, state, visit);
//
//  1. A voxel is divided no further if it has kFew objects or fewer, at the greatest depth, and where
//     division no longer separates: if its eight parts would list more than kMostCopies times its objects
//     together.
//  2. Voxels have integer coordinates in units of a smallest voxel, whose planes are the same numbers for all
//     voxels that meet there. After a leaf, the ray is in the smallest voxel beyond the face through which it
//     leaves: on the axis of that face, the coordinate follows from the face, as if from a point half a
//     smallest voxel beyond it, and on the other two from the t of the exit. The source's point near an edge
//     or a corner needs no special case here.
//  3. The next leaf is found from the root (OctreeRestart::kRoot), or from the lowest voxel above the last
//     leaf that also holds the new point (kCommonAncestor), which the highest bit tells in which the old and
//     the new coordinates differ.
//  4. With c levels below the root, and if each division multiplies the objects' references by k, the source
//     estimates d·((2^c − 1)(k − 1) + 1)·n / 2^(3c) tests per ray, for d leaves. The references that are
//     really there replace the numerator in EstimatedShare (grid.h).
//  5. An object is asked once per ray, with the numbers of rays of QueryState. Laws 4 and 5 of grid.h hold.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

enum class OctreeRestart : std::uint8_t { kRoot, kCommonAncestor };

class Octree {
 public:
  static constexpr bool kOnce = true;
  static constexpr std::uint32_t kFew = 8;
  static constexpr int kDeepest = 12;
  static constexpr double kMostCopies = 4;

  explicit Octree(std::span<const Box3> boxes, OctreeRestart restart = OctreeRestart::kCommonAncestor);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    Place place;
    for (int axis = 0; axis < 3; ++axis) place.point[axis] = PointAt(ray, axis, 0, depth_, ray.t_first);
    Descend(place, depth_, 0);
    for (;;) {
      ++state.counters.regions;
      const Node& leaf = nodes_[place.path[place.level]];
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
        const std::uint32_t id = ids_[i];
        if (!state.FirstTime(id)) {
          ++state.counters.repeats;
          continue;
        }
        ++state.counters.tests;
        if (!Meets(ray, boxes_[id])) continue;
        Report(ray, state, id, visit);
        if (ray.ended()) return;
      }
      if (!GoOn(ray, place)) return;
    }
  }
  int depth() const { return depth_; }
  StateSize state_size() const { return {.stamps = boxes_.size()}; }
  std::size_t bytes() const;
  StructureFigures figures() const {
    return {static_cast<double>(leaves_), static_cast<double>(ids_.size()), depth_};
  }

 private:
  struct Node {
    std::uint32_t first = 0;  // of a leaf: in ids_; otherwise the first of eight children
    std::uint32_t count = 0;  // of a leaf
    bool inner = false;
  };
  // Where a ray is: the smallest voxel, the path from the root to its leaf, and the leaf's level. A voxel of
  // level s is 2^s smallest voxels wide; path[s] is the node of level s.
  struct Place {
    std::uint32_t point[3];
    std::uint32_t path[kDeepest + 1];
    int level;
  };

  // The plane between the smallest voxels number k − 1 and k of an axis.
  double Plane(int axis, std::uint32_t k) const { return planes_[axis][k]; }
  // The coordinate of the ray's smallest voxel at t, within the 2^level smallest voxels from `first` on.
  std::uint32_t PointAt(const SlabRay& ray, int axis, std::uint32_t first, int level, double t) const {
    // Count the planes that are passed, by halving.
    const bool up = ray.near_side[axis] == 0;
    std::uint32_t passed = 0;
    for (int bit = level - 1; bit >= 0; --bit) {
      const std::uint32_t more = passed + (std::uint32_t{1} << bit);
      const std::uint32_t plane = up ? first + more : first + (std::uint32_t{1} << level) - more;
      if (ray.Pass(axis, Plane(axis, plane)) <= t) passed = more;
    }
    return up ? first + passed : first + (std::uint32_t{1} << level) - 1 - passed;
  }
  // Finds the leaf of the point, from the voxel `node` of a level that holds it.
  void Descend(Place& place, int level, std::uint32_t node) const {
    place.path[level] = node;
    while (nodes_[node].inner) {
      --level;
      const std::uint32_t child = (place.point[0] >> level & 1) | (place.point[1] >> level & 1) << 1 |
                                  (place.point[2] >> level & 1) << 2;
      node = nodes_[node].first + child;
      place.path[level] = node;
    }
    place.level = level;
  }
  // Goes to the next leaf. Returns false if there is none, or if it begins behind the end of the interval.
  bool GoOn(const SlabRay& ray, Place& place) const {
    const int level = place.level;
    const std::uint32_t width = std::uint32_t{1} << level;
    std::uint32_t first[3];
    double leave = INFINITY;
    int axis = 0;
    for (int a = 0; a < 3; ++a) {
      first[a] = place.point[a] & ~(width - 1);
      const double t = ray.Pass(a, Plane(a, ray.near_side[a] == 0 ? first[a] + width : first[a]));
      if (t < leave) leave = t, axis = a;
    }
    if (leave > ray.t_last) return false;
    const bool up = ray.near_side[axis] == 0;
    if (up ? first[axis] + width == std::uint32_t{1} << depth_ : first[axis] == 0) return false;
    std::uint32_t changed = 0;
    for (int a = 0; a < 3; ++a) {
      const std::uint32_t point =
          a == axis ? (up ? first[a] + width : first[a] - 1) : PointAt(ray, a, first[a], level, leave);
      changed |= point ^ place.point[a];
      place.point[a] = point;
    }
    if (restart_ == OctreeRestart::kRoot) {
      Descend(place, depth_, 0);
    } else {
      // The voxel above the highest bit that changed holds both points.
      const int above = std::max(level, 32 - __builtin_clz(changed));
      Descend(place, above, place.path[above]);
    }
    return true;
  }

  struct Reach {
    std::uint16_t first[3], last[3];  // smallest voxels
  };
  void Divide(std::uint32_t node, int level, const std::array<std::uint32_t, 3>& first,
              const std::vector<std::uint32_t>& objects, const std::vector<Reach>& reaches);

  BoxSet boxes_;
  OctreeRestart restart_;
  int depth_ = 0;
  std::array<std::vector<double>, 3> planes_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
  std::size_t leaves_ = 0;
};

}  // namespace facetless
