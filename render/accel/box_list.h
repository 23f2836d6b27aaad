// A plain list of boxes, tested one after the other (A. Formella, D. Fellner, "Beschleunigungsverfahren bei
// der Schnittpunktberechnung", section "Einführung von BoundingVolumes"). The other structures are measured
// against it, and tests hold them to what it finds.
//
//     const BoxList list(boxes);
//     QueryState state(list.state_size());
//     list.Visit({origin, direction}, state, visit);
//
//  1. The ray's interval is tested against each box, in the order of ids and not from front to back: n tests
//     per ray. Boxes that begin behind the nearest hit so far are left out.
#pragma once

#include <span>

#include "render/accel/structure.h"

namespace facetless {

class BoxList {
 public:
  static constexpr bool kOnce = true;

  explicit BoxList(std::span<const Box3> boxes) : boxes_(boxes) {}

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    ++state.counters.regions;
    boxes_.Scan(ray, state, visit);
  }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const { return boxes_.bytes(); }
  StructureFigures figures() const { return {1, static_cast<double>(boxes_.size()), 0}; }

 private:
  BoxSet boxes_;
};

}  // namespace facetless
