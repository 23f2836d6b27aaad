// Plane traversal (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der Schnittpunktberechnung",
// section "PlaneTraversal"): the six planes of each box, sorted on each axis, are passed by the ray one after
// the other, and each box counts on how many axes the ray is inside.
//
//     const PlaneTraversal traversal(boxes);
//     QueryState state(traversal.state_size());
//     traversal.Visit({origin, direction}, state, visit);
//
//  1. Passing the first plane of a box on an axis sets the box's bit of that axis, and passing the second one
//     clears it. When all three bits are set, the ray is inside the box, and the object is asked. Bits are
//     counted, which is enough: a box's planes on an axis are passed in turn.
//  2. The planes of all axes are passed in the order of their t, beginning in front of all boxes, also where
//     the ray begins among them. So boxes are met from front to back, and each at most once.
//  3. The traversal stops at the first plane that is passed behind the nearest hit, and when all planes of
//     one axis are passed.
//  4. A ray passes up to 6·n planes. For the few boxes of a voxel this is fast; over a whole scene it is
//     slow, and serves to compare.
//  5. Rays from so far away that rounding exceeds the boxes' margin (BoxSet::TooFar) are answered by a scan.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

// A side of a box.
struct BoxPlane {
  double at;
  std::uint32_t box;  // its number
  bool high;          // which side
};

// Appends the planes of `boxes`, of the three axes one after the other, each axis in ascending order.
void AppendPlanes(std::span<const SlabBox> boxes, std::vector<BoxPlane>& planes);

// Passes the planes of `count` boxes as AppendPlanes leaves them. change(number, ±1) changes the box's
// counter, which is 0 at the beginning, and returns it; enter(number) is called when the ray enters a box. A
// box that is left before t_first is entered, too; the caller tests it.
template <typename Change, typename Enter>
void PassPlanes(const SlabRay& ray, const BoxPlane* planes, std::size_t count, const Change& change,
                const Enter& enter) {
  const std::size_t sides = 2 * count;
  std::size_t passed[3] = {0, 0, 0};
  const auto plane = [&](int axis) -> const BoxPlane& {
    const std::size_t place = ray.near_side[axis] == 0 ? passed[axis] : sides - 1 - passed[axis];
    return planes[axis * sides + place];
  };
  double t[3];
  for (int axis = 0; axis < 3; ++axis) t[axis] = ray.Pass(axis, plane(axis).at);
  for (;;) {
    const int axis = t[0] <= t[1] ? (t[0] <= t[2] ? 0 : 2) : (t[1] <= t[2] ? 1 : 2);
    if (t[axis] > ray.t_last || ray.ended()) return;
    const BoxPlane& side = plane(axis);
    const bool first = side.high == (ray.near_side[axis] == 1);
    if (change(side.box, first ? 1 : -1) == 3 && first) enter(side.box);
    if (++passed[axis] == sides) return;
    t[axis] = ray.Pass(axis, plane(axis).at);
  }
}

class PlaneTraversal {
 public:
  static constexpr bool kOnce = true;

  explicit PlaneTraversal(std::span<const Box3> boxes);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    ++state.counters.regions;
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    // A counter is a stamp: four times the number of the ray, plus the axes. Older stamps count as zero.
    const std::uint32_t zero = 4 * state.ray();
    std::uint32_t* const stamps = state.stamps();
    PassPlanes(
        ray, planes_.data(), boxes_.size(),
        [&](std::uint32_t id, int by) {
          stamps[id] = std::max(stamps[id], zero) + static_cast<std::uint32_t>(by);
          return stamps[id] - zero;
        },
        [&](std::uint32_t id) {
          ++state.counters.tests;
          if (Meets(ray, boxes_[id])) Report(ray, state, id, visit);
        });
  }
  StateSize state_size() const { return {.stamps = boxes_.size()}; }
  std::size_t bytes() const { return boxes_.bytes() + planes_.capacity() * sizeof(BoxPlane); }
  StructureFigures figures() const { return {1, static_cast<double>(boxes_.size()), 0}; }

 private:
  BoxSet boxes_;
  std::vector<BoxPlane> planes_;
};

}  // namespace facetless
