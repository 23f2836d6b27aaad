// Voxels between planes: three sets of planes across the axes divide the box of the scene into voxels, a ray
// steps from one to the next, and each voxel lists the objects that reach into it. Grid, Lattice and SsmLists
// differ in their planes; BmssmSlices steps in the same way, and needs no lists.
//
//     const VoxelPlanes planes = EvenPlanes(boxes.bounds(), {8, 8, 8});
//     for (VoxelWalk walk(ray, planes, ray.t_first);;) {
//       Ask(walk.voxel());
//       if (!walk.Next(ray.t_last)) break;
//     }
//
//  1. The voxels of a ray are those of a 3D-DDA (in the source of Grid, a modified Bresenham's algorithm):
//     from a voxel, the ray goes on through the face that it reaches first, one axis at a time, also through
//     edges and corners. Voxels need not have equal intervals.
//  2. A plane at p is passed at SlabRay::Pass(axis, p), wherever it is asked for. A box that lies between the
//     planes i and j of an axis is therefore met between their t, without any tolerance: the walk visits a
//     voxel of each box that the ray meets, before or at its entry (law 5 of structure.h).
//  3. Planes ascend, and may coincide. The first and the last are those of the scene's box.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

class VoxelPlanes {
 public:
  VoxelPlanes() = default;
  // Planes per axis, at least two for each.
  explicit VoxelPlanes(std::array<std::vector<double>, 3> at) : at_(std::move(at)) {}

  // The number of intervals of an axis.
  std::uint32_t count(int axis) const { return static_cast<std::uint32_t>(at_[axis].size()) - 1; }
  std::uint32_t voxels() const { return count(0) * count(1) * count(2); }
  const double* axis(int axis) const { return at_[axis].data(); }
  std::size_t bytes() const {
    return (at_[0].capacity() + at_[1].capacity() + at_[2].capacity()) * sizeof(double);
  }
  // The first and the last interval of an axis that the box reaches into.
  struct Range {
    std::uint32_t first, last;
  };
  Range Reach(const SlabBox& box, int axis) const;

 private:
  std::array<std::vector<double>, 3> at_;
};

// Equal intervals. Requires counts ≥ 1.
VoxelPlanes EvenPlanes(const SlabBox& bounds, const std::array<std::uint32_t, 3>& counts);

// Intervals whose planes lie at boundaries of boxes, with about as many boundaries in each. Near the place
// that would be even, the boundary is taken that cuts the fewest boxes (lattice.h).
VoxelPlanes BoundaryPlanes(const BoxSet& boxes, const std::array<std::uint32_t, 3>& counts);

// The numbers of intervals that make nearly cubic voxels, `per_object` for each object if they were spread
// evenly; at most `most` on each axis.
std::array<std::uint32_t, 3> CubicCounts(const BoxSet& boxes, double per_object, std::uint32_t most);

// The number of objects that all voxels list together.
std::uint64_t CountReferences(const BoxSet& boxes, const VoxelPlanes& planes);

// The voxels that a ray passes, in order, from parameter t on.
class VoxelWalk {
 public:
  VoxelWalk(const SlabRay& ray, const VoxelPlanes& planes, double t) : ray_(ray), planes_(planes) {
    std::int64_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
      Start(axis, t);
      stride_[axis] = stride * step_[axis];
      voxel_ += stride * cell_[axis];
      stride *= planes.count(axis);
    }
  }

  std::uint32_t cell(int axis) const { return static_cast<std::uint32_t>(cell_[axis]); }
  // The number of the present voxel: x + count_x·(y + count_y·z).
  std::size_t voxel() const { return static_cast<std::size_t>(voxel_); }
  // Goes to the next voxel. Returns false if there is none, or if it begins behind t_last.
  bool Next(double t_last) {
    const int axis =
        leave_[0] <= leave_[1] ? (leave_[0] <= leave_[2] ? 0 : 2) : (leave_[1] <= leave_[2] ? 1 : 2);
    if (leave_[axis] > t_last) return false;
    cell_[axis] += step_[axis];
    if (cell_[axis] < 0 || cell_[axis] >= static_cast<std::int32_t>(planes_.count(axis))) return false;
    voxel_ += stride_[axis];
    SetLeave(axis);
    return true;
  }

 private:
  // The last interval, in the ray's order, whose first plane is passed at or before t.
  void Start(int axis, double t) {
    const double* at = planes_.axis(axis);
    const std::uint32_t count = planes_.count(axis);
    step_[axis] = ray_.near_side[axis] == 0 ? 1 : -1;
    // Count the inner planes that are passed by then, by halving.
    std::uint32_t low = 0, high = count - 1;
    while (low < high) {
      const std::uint32_t middle = (low + high + 1) / 2;
      const double plane = step_[axis] > 0 ? at[middle] : at[count - middle];
      if (ray_.Pass(axis, plane) <= t)
        low = middle;
      else
        high = middle - 1;
    }
    cell_[axis] = static_cast<std::int32_t>(step_[axis] > 0 ? low : count - 1 - low);
    SetLeave(axis);
  }
  void SetLeave(int axis) {
    leave_[axis] = ray_.Pass(axis, planes_.axis(axis)[cell_[axis] + (step_[axis] > 0 ? 1 : 0)]);
  }

  const SlabRay& ray_;
  const VoxelPlanes& planes_;
  std::int32_t cell_[3], step_[3];
  std::int64_t stride_[3], voxel_ = 0;
  double leave_[3];
};

// For each voxel, the objects that reach into it.
class VoxelLists {
 public:
  VoxelLists(const BoxSet& boxes, const VoxelPlanes& planes);

  std::span<const std::uint32_t> Voxel(std::size_t voxel) const {
    return {ids_.data() + begin_[voxel], begin_[voxel + 1] - begin_[voxel]};
  }
  std::uint64_t references() const { return ids_.size(); }
  std::size_t bytes() const { return (begin_.capacity() + ids_.capacity()) * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> begin_, ids_;
};

// Visits the boxes of the voxels that a ray passes. With `once`, the stamps of the state keep an object from
// being asked again by the same ray, whether its box was met or not (the source of Grid calls this numbers of
// rays).
template <bool once, typename Visitor>
void VisitVoxels(const BoxSet& boxes, const VoxelPlanes& planes, const VoxelLists& lists,
                 const RaySegment& segment, QueryState& state, Visitor& visit) {
  SlabRay ray;
  if (!boxes.Enter(segment, ray)) return;
  state.NextRay();
  if (boxes.TooFar(ray)) return boxes.Scan(ray, state, visit);
  VoxelWalk walk(ray, planes, ray.t_first);
  do {
    ++state.counters.regions;
    for (const std::uint32_t id : lists.Voxel(walk.voxel())) {
      if constexpr (once) {
        if (!state.FirstTime(id)) {
          ++state.counters.repeats;
          continue;
        }
      }
      ++state.counters.tests;
      if (!Meets(ray, boxes[id])) continue;
      Report(ray, state, id, visit);
      if (ray.ended()) return;
    }
  } while (walk.Next(ray.t_last));
}

}  // namespace facetless
