// Embree's tree over user geometry (Embree 3.13, rtcSetGeometryIntersectFunction), over the same boxes as the
// other structures: the peer that they are compared with.
//
//     const Result<EmbreeBoxes> tree = EmbreeBoxes::Build(boxes);
//     QueryState state(tree.value().state_size());
//     tree.value().Visit({origin, direction}, state, visit);
//
//  1. Embree calculates in float32. Boxes are given in units of the scene's size, relative to its middle, and
//     larger by 2^-20 of it, which covers the rounding of the ray and of Embree's tests (its robust mode).
//     What Embree visits is tested in double precision before the visitor is called.
//  2. A ray is given to Embree from where it enters the box of the scene.
//  3. Embree visits boxes nearly from front to back. Boxes that begin behind the nearest hit are left out.
//  4. Rays that start more than 2^10 sizes of the scene away are answered by a scan.
#pragma once

#include <memory>
#include <span>

#include "render/accel/structure.h"
#include "render/base/result.h"

namespace facetless {

class EmbreeBoxes {
 public:
  static constexpr bool kOnce = true;

  // Errors: kBadUsage (the processor lacks SSE2); kLimitExceeded (memory); kInternal (Embree reports an
  // error).
  static Result<EmbreeBoxes> Build(std::span<const Box3> boxes);
  ~EmbreeBoxes();
  EmbreeBoxes(EmbreeBoxes&&) noexcept;
  EmbreeBoxes& operator=(EmbreeBoxes&&) noexcept;

  template <typename Visitor>
  void Visit(const RaySegment& segment, QueryState& state, Visitor&& visit) const {
    SlabRay ray;
    if (!boxes().Enter(segment, ray)) return;
    state.NextRay();
    ++state.counters.regions;
    if (TooFar(ray)) return boxes().Scan(ray, state, visit);
    struct Context {
      const BoxSet& boxes;
      SlabRay& ray;
      QueryState& state;
      Visitor& visit;
    } context{boxes(), ray, state, visit};
    Trace(
        ray,
        [](void* pointer, std::uint32_t id) {
          Context& c = *static_cast<Context*>(pointer);
          ++c.state.counters.tests;
          if (!c.ray.ended() && Meets(c.ray, c.boxes[id])) Report(c.ray, c.state, id, c.visit);
          return c.ray.t_last;
        },
        &context);
  }
  StateSize state_size() const { return {}; }
  std::size_t bytes() const;  // what Embree has allocated, and the boxes
  StructureFigures figures() const { return {1, static_cast<double>(boxes().size()), 0}; }

  struct Data;

 private:
  // Tests box `id`, and returns the end of the interval.
  using Ask = double (*)(void* context, std::uint32_t id);

  explicit EmbreeBoxes(std::unique_ptr<Data> data);
  const BoxSet& boxes() const;
  bool TooFar(const SlabRay& ray) const;
  void Trace(const SlabRay& ray, Ask ask, void* context) const;

  std::unique_ptr<Data> data_;
};

}  // namespace facetless
