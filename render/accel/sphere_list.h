// A plain list of bounding spheres, tested one after the other (A. Formella, D. Fellner,
// "Beschleunigungsverfahren bei der Schnittpunktberechnung", section "Einführung von BoundingVolumes"; the
// test follows V. Skala, section 4).
//
//     const SphereList list(boxes);
//     QueryState state(list.state_size());
//     list.Visit({origin, direction}, state, visit);
//
//  1. A sphere encloses its box: same centre, and the radius is half of the diagonal. With the centre's
//     vector s from the origin and the direction d, the ray's line meets it if |s − ((s·d)/(d·d))·d|² ≤ r².
//     The source evaluates (s·d)² − (d·d)·(s·s − r²) ≥ 0, which is the same in real numbers, but loses all
//     digits for small spheres far away.
//  2. The interval is tested as well: a sphere lies between (s·d)/(d·d) ± r/|d|.
//  3. A sphere around a box holds more than the box, so its candidates include boxes that the ray misses.
//     Which of the two is cheaper for an object is the subject of volume_choice.h.
//  4. Spheres are tested in the order of ids. Rays from so far away that rounding exceeds the spheres' margin
//     (BoxSet::TooFar) are answered by a scan of the boxes.
#pragma once

#include <span>
#include <vector>

#include "render/accel/structure.h"

namespace facetless {

struct BoundingSphere {
  double centre[3];
  double radius;
};

// The sphere around a box. `margin` covers the rounding errors of MeetsSphere.
BoundingSphere SphereAround(const SlabBox& box, double margin);
// The margin for the boxes of a scene.
double SphereMargin(const BoxSet& boxes);

// What MeetsSphere needs of a ray beside its origin and direction.
struct SphereRay {
  explicit SphereRay(const SlabRay& ray);
  double inverse_square;  // 1 / (d·d)
  double inverse_length;  // 1 / |d|
};

inline bool MeetsSphere(const SlabRay& ray, const SphereRay& extra, const BoundingSphere& sphere) {
  const double x = sphere.centre[0] - ray.origin[0], y = sphere.centre[1] - ray.origin[1],
               z = sphere.centre[2] - ray.origin[2];
  const double t =
      (x * ray.direction[0] + y * ray.direction[1] + z * ray.direction[2]) * extra.inverse_square;
  const double across_x = x - t * ray.direction[0], across_y = y - t * ray.direction[1],
               across_z = z - t * ray.direction[2];
  const double half = sphere.radius * extra.inverse_length;
  return (across_x * across_x + across_y * across_y + across_z * across_z <= sphere.radius * sphere.radius) &
         (t + half >= ray.t_first) & (t - half <= ray.t_last);
}

class SphereList {
 public:
  static constexpr bool kOnce = true;

  explicit SphereList(std::span<const Box3> boxes);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    ++state.counters.regions;
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    const SphereRay extra(ray);
    for (std::uint32_t id = 0; id < spheres_.size() && !ray.ended(); ++id) {
      ++state.counters.tests;
      if (MeetsSphere(ray, extra, spheres_[id])) Report(ray, state, id, visit);
    }
  }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const { return boxes_.bytes() + spheres_.capacity() * sizeof(BoundingSphere); }
  StructureFigures figures() const { return {1, static_cast<double>(boxes_.size()), 0}; }

 private:
  BoxSet boxes_;
  std::vector<BoundingSphere> spheres_;
};

}  // namespace facetless
