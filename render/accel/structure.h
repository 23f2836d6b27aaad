// What the structures have in common that find objects for a ray in any direction. Each is built over
// axis-aligned boxes with the ids 0 … n−1, and visits the boxes that a ray may meet, so that a caller finds
// the nearest object without asking all of them.
//
//     const Bvh structure(boxes, BvhBuild::kTopDown);
//     QueryState state(structure.state_size());  // one for each thread, used for many rays
//     double nearest = INFINITY;
//     structure.Visit({origin, direction}, state, [&](std::uint32_t id) {
//       if (const auto t = Intersect(objects[id], origin, direction)) nearest = std::min(nearest, *t);
//       return nearest;  // for occlusion: kStop at the first hit
//     });
//
//  1. A structure is immutable for its callers once it is built, and any number of threads may ask it, each
//     with a QueryState of its own. A query allocates nothing (DirectionTree, which is built on demand, is
//     the exception that its header describes).
//  2. The visitor is called with the id of each box that the ray meets at a t with t_first ≤ t ≤ t_last, at
//     least once, and with ids of few other boxes. If kOnce of the structure is true, it is called at most
//     once per ray and id.
//  3. The visitor returns the end of the interval that still matters: the t of the nearest hit, or t_last as
//     long as there is none. The interval only shrinks. A value below t_first, such as kStop, ends the visit.
//     Boxes that begin behind the end are left out, but not those that begin exactly there, so that equal t
//     can be decided by the lower id.
//  4. The structure goes through its regions from front to back, and ends before the first region that begins
//     behind the end of the interval. A root that lies in a later region than the present one is kept, and
//     not refused: it is the answer if no nearer root is found before the visit ends.
//  5. Law 2 is a statement about real numbers, not about rounded ones. Boxes are made larger by a margin
//     (BoxSet), and a plane at coordinate p is passed at ((p − o) · 1/d) with a relative error below 2^-51.
//     The rounded expression is monotone in p, so that a structure whose planes enclose a box's planes meets
//     its regions whenever it meets the box.
//  6. An object's t may be computed less exactly than that, but it must not lie before the box's entry by
//     more than the margin, 2^-40 of the size of the scene. A caller whose roots are less exact makes its
//     boxes larger.
//
// Requires: boxes with low ≤ high and coordinates up to 1e100, fewer than 2^30 of them; t_first ≥ 0. A ray
// whose origin or direction is not finite, or whose direction is zero, meets nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/base/vec.h"

namespace facetless {

// The points origin + t·direction with t_first ≤ t ≤ t_last. The direction may have any length.
struct RaySegment {
  Vec3 origin, direction;
  double t_first = 0, t_last = INFINITY;
};

// What a visitor returns to end the visit.
inline constexpr double kStop = -INFINITY;

// What queries have done since the counters were made.
struct QueryCounters {
  std::uint64_t rays = 0;        // that entered the box of the scene
  std::uint64_t regions = 0;     // voxels, nodes or pyramids that were visited (d of the sources)
  std::uint64_t tests = 0;       // bounding volumes of objects that were tested
  std::uint64_t candidates = 0;  // objects that the visitor was called with
  std::uint64_t repeats = 0;     // objects that were left out, since this ray had asked them before
};

// How much memory of the query's state a structure uses.
struct StateSize {
  std::size_t stamps = 0;  // numbers of rays, one for each object
  std::size_t words = 0;   // words of a bitmap
  std::size_t stack = 0;   // nodes that wait
};

// The part of a query that changes. One object serves one thread, and one structure.
class QueryState {
 public:
  explicit QueryState(StateSize size);

  // Begins a ray: no object has been asked.
  void NextRay() {
    ++counters.rays;
    // Stamps have two bits below the ray's number (PlaneTraversal counts with them).
    if (++ray_ == kMostRays) ForgetRays();
  }
  // Returns whether this is the ray's first call for the object.
  bool FirstTime(std::uint32_t id) {
    if (stamps_[id] == ray_) return false;
    stamps_[id] = ray_;
    return true;
  }
  // The number of the ray, which stamps of the present ray have, and others never.
  std::uint32_t ray() const { return ray_; }
  std::uint32_t* stamps() { return stamps_.data(); }
  std::uint64_t* words() { return words_.data(); }  // all zero between queries
  std::size_t bytes() const;

  struct Waiting {
    std::uint32_t node;
    double t_in, t_out;
  };
  Waiting* stack() { return stack_.data(); }
  // The words that the present query has written to.
  std::vector<std::uint32_t>& touched() { return touched_; }

  QueryCounters counters;

 private:
  static constexpr std::uint32_t kMostRays = std::uint32_t{1} << 30;
  void ForgetRays();

  std::uint32_t ray_ = 0;
  std::vector<std::uint32_t> stamps_, touched_;
  std::vector<std::uint64_t> words_;
  std::vector<Waiting> stack_;
};

// A box whose sides are chosen by the sign of the ray's direction: side[0] is low, side[1] is high.
struct SlabBox {
  double side[2][3];

  Vec3 low() const { return {side[0][0], side[0][1], side[0][2]}; }
  Vec3 high() const { return {side[1][0], side[1][1], side[1][2]}; }
};

// The smallest box that holds both.
SlabBox UnionOf(const SlabBox& a, const SlabBox& b);
// Half of the surface of a box.
double HalfSurface(const SlabBox& box);

// A ray prepared for tests of slabs. Its direction is scaled by a power of two, exactly, so that the largest
// component lies in [1, 2); `unit` converts the caller's t to the ray's. Components below 2^-200 are replaced
// by ±2^-200: over a scene's length, the difference is far below the margin.
struct SlabRay {
  double origin[3], direction[3];
  double inverse[3];                       // 1 / direction
  double near_inverse[3], far_inverse[3];  // smaller and larger by 2^-50, for entries and exits
  int near_side[3];  // the side of a box that is entered: 0 if the direction is positive
  double t_first, t_last;
  double unit;

  // Where the plane at coordinate `at` of an axis is passed.
  double Pass(int axis, double at) const { return (at - origin[axis]) * inverse[axis]; }
  // Whether a visitor has ended the visit.
  bool ended() const { return !(t_first <= t_last); }
};

// Returns whether the ray meets the box within its interval, and where it enters and leaves it.
inline bool Meets(const SlabRay& ray, const SlabBox& box, double& t_in, double& t_out) {
  // The three axes are written out: a loop is not unrolled everywhere, and takes twice the time.
  const auto enter = [&](int axis) {
    return (box.side[ray.near_side[axis]][axis] - ray.origin[axis]) * ray.near_inverse[axis];
  };
  const auto leave = [&](int axis) {
    return (box.side[1 - ray.near_side[axis]][axis] - ray.origin[axis]) * ray.far_inverse[axis];
  };
  t_in = std::max(std::max(ray.t_first, enter(0)), std::max(enter(1), enter(2)));
  t_out = std::min(std::min(ray.t_last, leave(0)), std::min(leave(1), leave(2)));
  return t_in <= t_out;
}
inline bool Meets(const SlabRay& ray, const SlabBox& box) {
  double t_in, t_out;
  return Meets(ray, box, t_in, t_out);
}

// Calls the visitor, and shortens the interval to what it returns.
template <typename Visitor>
void Report(SlabRay& ray, QueryState& state, std::uint32_t id, Visitor& visit) {
  ++state.counters.candidates;
  const double end = visit(id) * ray.unit;
  if (end < ray.t_last) ray.t_last = end;
}

// The boxes of a scene, made larger by the margin, and their common box.
class BoxSet {
 public:
  explicit BoxSet(std::span<const Box3> boxes);

  std::uint32_t size() const { return size_; }
  const SlabBox& operator[](std::size_t id) const { return boxes_[id]; }
  std::span<const SlabBox> boxes() const { return boxes_; }
  const SlabBox& bounds() const { return bounds_; }
  double margin() const { return margin_; }
  double scale() const { return scale_; }  // the size of the scene, above 0
  std::size_t bytes() const { return boxes_.capacity() * sizeof(SlabBox); }
  // Gives the memory of the boxes back, for a structure that has copies of its own. Scan is not possible
  // then.
  void ReleaseBoxes() { std::vector<SlabBox>().swap(boxes_); }

  // Prepares the ray, with its interval clipped to the common box. Returns false if it misses that box.
  bool Enter(const RaySegment& segment, SlabRay& ray) const;
  // Returns whether the ray starts so far away that its rounding errors exceed the margin. Structures that
  // step from voxel to voxel leave such rays to Scan.
  bool TooFar(const SlabRay& ray) const;
  // Tests one box after the other.
  template <typename Visitor>
  void Scan(SlabRay& ray, QueryState& state, Visitor& visit) const {
    for (std::uint32_t id = 0; id < size() && !ray.ended(); ++id) {
      ++state.counters.tests;
      if (Meets(ray, boxes_[id])) Report(ray, state, id, visit);
    }
  }

 private:
  std::uint32_t size_ = 0;
  std::vector<SlabBox> boxes_;
  SlabBox bounds_{};
  double margin_ = 0, scale_ = 0;
};

// How finely a structure divides space, for the sources' estimates of its work.
struct StructureFigures {
  double regions = 1;     // voxels, leaves of a tree, or pyramids (c³ of the source)
  double references = 0;  // objects that they list, in all (k·n)
  int depth = 0;          // of a tree
};

// What a structure is, beside a visit: `structure.Visit(segment, state, visit)` as described above.
template <typename T>
concept CandidateStructure = requires(const T& structure) {
  { T::kOnce } -> std::convertible_to<bool>;
  { structure.state_size() } -> std::same_as<StateSize>;
  { structure.bytes() } -> std::same_as<std::size_t>;  // of the structure, without the query's state
  { structure.figures() } -> std::same_as<StructureFigures>;
};

}  // namespace facetless
