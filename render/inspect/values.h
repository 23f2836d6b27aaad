// The numbers of an inspection picture: curvature, draft or thickness per sample, and their statistics.
//
//     auto values = InspectionValues(model, &scene, samples, frame, inspection, {});
//     if (!values) return values.error();
//     const ValueStatistics statistics = ComputeStatistics(values.value(), samples);
//
//  1. If the samples have native parameters (SampleBuffer::uv), normals and derivatives are evaluated on the
//     surface in double. Otherwise, draft uses the normals of the samples, and curvature and thickness give
//     kBadUsage.
//  2. A sample without a number (a miss, a pole, an open shell) has the value +inf, as in a depth image.
//     Values are never NaN.
//  3. The robust range extends from the 2nd to the 98th percentile of the numbers. For curvature it is
//     symmetric about 0, and not narrower than what counts as flat for a model of this size. For thickness it
//     begins at 0.
//  4. The outside is that of the file, or, with Orient::kViewer, the side that the viewer sees. With kViewer,
//     a surface with reversed orientation has the same draft, curvature and thickness as one with correct
//     orientation.
//  5. The values are the same for any number of threads and any instruction set; sqrt is the only libm
//     function used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/base/large_pages.h"
#include "render/inspect/inspection.h"
#include "render/nurbs/surface_eval.h"
#include "render/trace/direct.h"

namespace facetless {

// The name and the unit of a quantity as in the legend ("mean curvature", "1/mm"), and whether it has a sign.
// Only kinds for which HasValues returns true have a quantity.
struct Quantity {
  std::string name, unit;
  bool has_sign = false;
};
bool HasValues(InspectionKind kind);
Quantity InspectionQuantity(const Inspection& inspection);

// Returns whether the viewer sees the surface from inside, by more than the rounding error of a float32
// normal (kSettled).
inline constexpr double kSettled = 0x1p-20;  // eight units in the last place
bool IsBack(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i);

// Returns whether the tracer must fill SampleBuffer::uv so that InspectionValues is exact.
bool NeedsUv(InspectionKind kind);

// Computes the value of each sample. Requires a kind for which HasValues is true. `scene` is the scene of the
// model, or null for samples of a mesh. Errors: kBadUsage (law 1), kSizeMismatch, kCancelled.
Result<PerSample<double>> InspectionValues(const Model& model, const Scene* scene,
                                           const SampleBuffer& samples, const CameraFrame& frame,
                                           const Inspection& inspection, const Execution& execution);

struct ValueStatistics {
  std::size_t count = 0, none = 0;  // hits with and without a number
  double min = 0, max = 0, mean = 0, p2 = 0, p50 = 0, p98 = 0;
};
ValueStatistics ComputeStatistics(const PerSample<double>& values, const SampleBuffer& samples);

// `inspection.range` if it is set, or else the robust range of law 3.
ValueRange ResolveRange(const Inspection& inspection, const ValueStatistics& statistics, double diagonal_mm);

}  // namespace facetless
