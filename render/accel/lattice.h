// A lattice (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der Schnittpunktberechnung", section
// "Lattice"): voxels between planes that lie at boundaries of objects, with intervals of their own on each
// axis.
//
//     const Lattice lattice(boxes);
//     QueryState state(lattice.state_size());
//     lattice.Visit({origin, direction}, state, visit);
//
//  1. Each inner plane lies at a side of a box, near the place where equally many sides lie in each interval,
//     and there where it cuts the fewest boxes. So fewer objects are listed twice than in a grid, and
//     clusters get more planes than voids.
//  2. The numbers of intervals c_x, c_y and c_z follow the shape of the scene. A ray asks d·k·n /
//     (c_x·c_y·c_z) objects if they are spread evenly (EstimatedShare of grid.h).
//  3. The rest is as for Grid: a 3D-DDA, one question per ray and object, and the laws 4 and 5 of grid.h.
#pragma once

#include <span>

#include "render/accel/structure.h"
#include "render/accel/voxels.h"

namespace facetless {

class Lattice {
 public:
  static constexpr bool kOnce = true;

  explicit Lattice(std::span<const Box3> boxes);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    VisitVoxels<true>(boxes_, planes_, lists_, segment, state, visit);
  }
  const VoxelPlanes& planes() const { return planes_; }
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

}  // namespace facetless
