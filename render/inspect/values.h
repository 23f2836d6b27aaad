// The numbers behind an inspection picture: curvature, draft, thickness per sample, and what they are like as
// a whole.
//
//  1. With the samples' native parameters (SampleBuffer::uv) normals and derivatives are those of the surface
//     in double; without, draft is of the samples' own normals, and curvature and thickness are kBadUsage.
//  2. No number is +inf, as in a depth image: nothing hit, a pole, an open shell. Never NaN.
//  3. A robust range runs from the 2nd to the 98th percentile of the numbers; for curvature it is symmetric
//     about 0, and never narrower than what is flat for a model of this size. Thickness begins at 0.
//  4. The outside is the file's, or with Orient::kViewer the side that is seen: a surface that is drawn
//     inside out then has the draft, curvature and thickness of one that is not.
//  5. The same values for any number of threads and any instruction set: no libm but sqrt.
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

// Whether the kind has numbers at all, their name and unit as a legend has them ("mean curvature", "1/mm"),
// and whether 0 divides them.
struct Quantity {
  std::string name, unit;
  bool has_sign = false;
};
bool HasValues(InspectionKind kind);
Quantity QuantityOf(const Inspection& inspection);

// Whether the viewer sees the surface from inside, by more than the rounding of a normal in float32
// (kSettled).
inline constexpr double kSettled = 0x1p-20;  // eight units in the last place
bool IsBack(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i);

// Whether the tracer must fill uv for Values to be exact.
bool WantsUv(InspectionKind kind);

// Requires HasValues. `scene` is the model's, or null: a mesh's samples. Errors: kBadUsage (law 1),
// kSizeMismatch, kCancelled.
Result<PerSample<double>> InspectionValues(const Model& model, const Scene* scene,
                                           const SampleBuffer& samples, const CameraFrame& frame,
                                           const Inspection& inspection, const Execution& execution);

struct ValueStatistics {
  std::size_t count = 0, none = 0;  // hits with and without a number
  double min = 0, max = 0, mean = 0, p2 = 0, p50 = 0, p98 = 0;
};
ValueStatistics StatisticsOf(const PerSample<double>& values, const SampleBuffer& samples);

// Law 3; `inspection.range` if it is given.
ValueRange RangeOf(const Inspection& inspection, const ValueStatistics& statistics, double diagonal_mm);

}  // namespace facetless
