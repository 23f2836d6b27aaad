// The cost model of bounding volumes (A. Formella, D. Fellner, "Beschleunigungsverfahren bei der
// Schnittpunktberechnung", section "Einführung von BoundingVolumes"), which chooses a sphere or a box for
// each object, and the plain list of the volumes that it chooses.
//
//     const VolumeChoice list(boxes, objects, MeasureVolumeCosts());
//     QueryState state(list.state_size());
//     list.Visit({origin, direction}, state, visit);
//
//  1. Rays that are tested against the volume v of an object o cost K(o, v) = n·B(v) + m(v)·I(o): n is the
//     number of rays, B(v) the time of a test of the volume, m(v) the number of rays that meet it, and I(o)
//     the time of an intersection with the object (TotalCost).
//  2. m(v) is estimated from the fit p = V(o)/V(v): of the rays that meet v, the share p meets o, so that
//     m(v) = m(o)/p, and at most n. For rays in all directions, m(o)/n is the ratio of the surfaces of the
//     object and of the scene; the surface of an object is estimated as that of a ball of its volume.
//  3. An object without a volume, such as a plate, has no fit. Its m(v)/n is the ratio of the surfaces of v
//     and of the scene, to which law 2 amounts for convex volumes in any case.
//  4. The volume with the smaller K is chosen, and the box if both cost the same.
//  5. B(box) and B(sphere) are measured by MeasureVolumeCosts on the machine at hand, as the time of a plain
//     list (BoxList, SphereList) per volume. Of kVolumeCosts, which was measured in the same way, the ratio
//     matters.
#pragma once

#include <span>
#include <vector>

#include "render/accel/sphere_list.h"
#include "render/accel/structure.h"

namespace facetless {

enum class Volume : std::uint8_t { kBox, kSphere };

// B(v) for both volumes, in nanoseconds.
struct VolumeCosts {
  double box_ns = 0, sphere_ns = 0;
};
inline constexpr VolumeCosts kVolumeCosts{2.05, 3.09};

// Measures B(v), in a few milliseconds.
VolumeCosts MeasureVolumeCosts();

// What is known of an object.
struct ObjectCost {
  double volume = 0;        // V(o)
  double intersect_ns = 0;  // I(o)
};

// K = n·B(v) + m(v)·I(o).
double TotalCost(double rays, double volume_ns, double meeting, double intersect_ns);
// p = V(o)/V(v); 0 if the object has no volume.
double Fit(double object_volume, double bounding_volume);
// m(v)/n for an object in `box`, whose scene has the surface `scene_surface`.
double MeetingShare(Volume volume, const SlabBox& box, double object_volume, double scene_surface);
Volume ChooseVolume(const SlabBox& box, const ObjectCost& object, const VolumeCosts& costs,
                    double scene_surface);

class VolumeChoice {
 public:
  static constexpr bool kOnce = true;

  // `objects` is parallel to `boxes`. If it is empty, objects are taken for the ellipsoids within their
  // boxes, and an intersection for ten times as costly as the test of a box.
  VolumeChoice(std::span<const Box3> boxes, std::span<const ObjectCost> objects, const VolumeCosts& costs);

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes_.Enter(segment, ray)) return;
    state.NextRay();
    ++state.counters.regions;
    if (boxes_.TooFar(ray)) return boxes_.Scan(ray, state, visit);
    for (std::size_t i = 0; i < in_boxes_.size() && !ray.ended(); ++i) {
      ++state.counters.tests;
      if (Meets(ray, boxes_[in_boxes_[i]])) Report(ray, state, in_boxes_[i], visit);
    }
    const SphereRay extra(ray);
    for (std::size_t i = 0; i < in_spheres_.size() && !ray.ended(); ++i) {
      ++state.counters.tests;
      if (MeetsSphere(ray, extra, spheres_[i])) Report(ray, state, in_spheres_[i], visit);
    }
  }
  std::size_t boxes() const { return in_boxes_.size(); }
  std::size_t spheres() const { return in_spheres_.size(); }
  // K of a ray by the model, for all objects together, with the chosen volumes, and if all had the same.
  double chosen_ns() const { return chosen_ns_; }
  double all_boxes_ns() const { return all_boxes_ns_; }
  double all_spheres_ns() const { return all_spheres_ns_; }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const {
    return boxes_.bytes() + spheres_.capacity() * sizeof(BoundingSphere) +
           (in_boxes_.capacity() + in_spheres_.capacity()) * sizeof(std::uint32_t);
  }
  StructureFigures figures() const { return {1, static_cast<double>(boxes_.size()), 0}; }

 private:
  BoxSet boxes_;
  std::vector<std::uint32_t> in_boxes_, in_spheres_;
  std::vector<BoundingSphere> spheres_;  // parallel to in_spheres_
  double chosen_ns_ = 0, all_boxes_ns_ = 0, all_spheres_ns_ = 0;
};

}  // namespace facetless
