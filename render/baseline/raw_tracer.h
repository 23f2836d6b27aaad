// Embree alone: what a view of a mesh costs if nothing but the distance and the triangle of each pixel is
// needed. The bench compares the direct renderer with it, because TraceBaseline also computes points and
// normals in double precision.
//
//     Result<RawResult> raw = TraceRaw(scene, camera, {.threads = 1});
//
//  1. The rays are those of TraceBaseline, in packets of 16 with Embree's flag for coherent rays. They are
//     stepped from pixel to pixel in float32.
//  2. The result is what Embree returns: a distance in float32 and the index of the triangle in its part.
//  3. There are no section planes.
#pragma once

#include <cstdint>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/view/samples.h"

namespace facetless {

struct RawResult {
  // The depth of a sample is start_mm + distance; the distance of a miss is infinite.
  PerSample<float> distance;
  PerSample<std::uint32_t> triangle;  // kNoIndex for a miss
  double start_mm = 0;
  double trace_ms = 0;
};

// Traces a view. Errors: kBadUsage (the camera, or one whose rays start far outside of the mesh), kLimitExceeded
// (the samples do not fit into memory), kCancelled.
Result<RawResult> TraceRaw(const BaselineScene& scene, const Camera& camera, const Execution& execution);

}  // namespace facetless
