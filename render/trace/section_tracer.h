// Tiles of a view that is cut open: all crossings of each ray, and what section.h makes of them.
//
//  1. One per thread, like the TileTracer that it asks. The planes and the solids are shared and only read.
//  2. A sample is certified if nothing on its whole ray is in doubt: a crossing that is missing or one too
//     many beyond the plane would turn a cap into a view of what lies behind it, or the other way round.
//  3. A cap's normal is the plane's, its depth the plane's own on the ray, its uv 0.
#pragma once

#include <span>
#include <vector>

#include "render/trace/tally.h"
#include "render/trace/tile_tracer.h"
#include "render/view/section.h"

namespace facetless {

class SectionTracer {
 public:
  // All outlive the tracer. `certify`: tell coincident faces from certified ones.
  SectionTracer(const TraceShared& shared, std::span<const SectionPlane> planes, const SectionSolids& solids,
                bool certify)
      : shared_(shared), planes_(planes), solids_(solids), certify_(certify) {}

  // Traces tile `index` and writes it into `samples`, which has a certificate and a doubt for every sample.
  void Trace(int index, TileTracer* tracer, SampleBuffer* samples, Tally* tally);

 private:
  struct Found {
    double depth = INFINITY, error = 0;
    std::uint32_t face = kNoIndex;
    Vec3 normal;
    std::uint8_t doubt = 0;
    const Crossing* crossing = nullptr;  // of what is no cap
  };
  Found Look(int column, int row, std::span<const Crossing> crossings, std::uint8_t doubt);

  const TraceShared& shared_;
  const std::span<const SectionPlane> planes_;
  const SectionSolids& solids_;
  const bool certify_;
  std::vector<Crossing> crossings_;
  std::vector<SolidCrossing> solid_crossings_;
  SectionDecision decision_;
};

// A crossing's error as sections take it. One without a bound is in doubt already, and its depth is the best
// there is.
inline double ErrorOf(const Crossing& crossing) {
  return std::isfinite(crossing.hit.error) ? crossing.hit.error : 0;
}

}  // namespace facetless
