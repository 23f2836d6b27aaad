// SectionTracer: traces the tiles of a view with section planes. It collects all crossings of each ray and
// decides by the laws of section.h.
//
//  1. Each thread has its own SectionTracer and TileTracer. The planes and the solids are shared and
//     read-only.
//  2. A sample is certified only if nothing on its whole ray is in doubt. A missing or an extra crossing
//     beyond the plane would turn a cap into a view of what lies behind it, or the reverse.
//  3. A cap has the normal of its plane, the depth at which the ray meets the plane, and uv 0.
#pragma once

#include <span>
#include <vector>

#include "render/trace/tally.h"
#include "render/trace/tile_tracer.h"
#include "render/view/section.h"

namespace facetless {

class SectionTracer {
 public:
  // All arguments must outlive the tracer. `certify`: detect coincident faces.
  SectionTracer(const TraceShared& shared, std::span<const SectionPlane> planes, const SectionSolids& solids,
                bool certify)
      : shared_(shared), planes_(planes), solids_(solids), certify_(certify) {}

  // Traces tile `index` and writes the results to `samples`, which must have certificates and doubts
  // allocated.
  void Trace(int index, TileTracer* tracer, SampleBuffer* samples, Tally* tally);

 private:
  struct Found {
    double depth = INFINITY, error = 0;
    std::uint32_t face = kNoIndex;
    Vec3 normal;
    std::uint8_t doubt = 0;
    const Crossing* crossing = nullptr;  // the crossing that was hit; null for a cap
  };
  Found ResolveSample(int column, int row, std::span<const Crossing> crossings, std::uint8_t doubt);

  const TraceShared& shared_;
  const std::span<const SectionPlane> planes_;
  const SectionSolids& solids_;
  const bool certify_;
  std::vector<Crossing> crossings_;
  std::vector<SolidCrossing> solid_crossings_;
  SectionDecision decision_;
};

// The depth error of a crossing for sections. A crossing without an error bound has a doubt already; its
// depth is the best estimate available, and its error counts as 0.
inline double ErrorOf(const Crossing& crossing) {
  return std::isfinite(crossing.hit.error) ? crossing.hit.error : 0;
}

}  // namespace facetless
