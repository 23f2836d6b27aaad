// A grid of c × c × c equal voxels (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der
// Schnittpunktberechnung", section "Grid"). Each voxel lists the objects whose boxes reach into it, and a ray
// goes from voxel to voxel by a 3D-DDA.
//
//     const Grid grid(boxes, {});
//     QueryState state(grid.state_size());
//     grid.Visit({origin, direction}, state, visit);
//
//  1. An object is listed in each voxel that its box reaches into: k·n references in c³ voxels. A ray that
//     passes d voxels asks d·k·n / c³ objects if they are spread evenly, and the source's grid pays if
//     d·k < c³ (EstimatedShare; c = 8, k = 1.1, d = 3 gives 0.0065).
//  2. GridSettings::c is the number of intervals of each axis. 0 chooses the c that makes kVoxelsPerObject
//     voxels for each object. c is lowered until the references number at most kMostReferences per object.
//  3. Visit asks an object once per ray, with the numbers of rays of QueryState. RepeatingGrid asks it in
//     every voxel, to measure what the numbers bring.
//  4. The root may lie in a later voxel than the present one. It is kept, and the visit ends when the next
//     voxel begins behind it (law 4 of structure.h).
//  5. Rays from so far away that rounding exceeds the boxes' margin (BoxSet::TooFar) are answered by a scan.
#pragma once

#include <span>

#include "render/accel/structure.h"
#include "render/accel/voxels.h"

namespace facetless {

struct GridSettings {
  std::uint32_t c = 0;  // intervals of each axis; 0: by the number of objects
};

// The share of n tests that remains, by the source's estimate: d regions of `regions` that list `references`
// objects in all.
double EstimatedShare(double d, const StructureFigures& figures, double objects);

class Grid {
 public:
  static constexpr bool kOnce = true;
  static constexpr double kVoxelsPerObject = 4;
  static constexpr double kMostReferences = 32;  // per object, on average
  static constexpr std::uint32_t kMostIntervals = 256;

  explicit Grid(std::span<const Box3> boxes, GridSettings settings = {});

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    VisitVoxels<true>(boxes_, planes_, lists_, segment, state, visit);
  }
  // As Visit, but an object is asked again in each voxel that lists it.
  template <typename Visitor>
  void VisitRepeatedly(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    VisitVoxels<false>(boxes_, planes_, lists_, segment, state, visit);
  }
  std::uint32_t c() const { return planes_.count(0); }
  StateSize state_size() const { return {.stamps = boxes_.size()}; }
  std::size_t bytes() const { return boxes_.bytes() + planes_.bytes() + lists_.bytes(); }
  StructureFigures figures() const {
    return {static_cast<double>(planes_.voxels()), static_cast<double>(lists_.references()), 1};
  }

 private:
  BoxSet boxes_;
  VoxelPlanes planes_;
  VoxelLists lists_;
};

// The same grid without numbers of rays: an object is asked in each voxel of the ray that lists it.
class RepeatingGrid {
 public:
  static constexpr bool kOnce = false;

  explicit RepeatingGrid(std::span<const Box3> boxes) : grid_(boxes) {}

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    grid_.VisitRepeatedly(segment, state, visit);
  }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const { return grid_.bytes(); }
  StructureFigures figures() const { return grid_.figures(); }

 private:
  Grid grid_;
};

}  // namespace facetless
