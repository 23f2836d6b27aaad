// Measuring one point of speed against accuracy.
//
//  1. Times are of a view with one sample per pixel. A run of less than kCheapMs is taken as the warm-up and
//     followed by kRepetitions others, of which the one with the median total is the answer; a longer one is
//     taken as it is.
//  2. The picture that FLIP looks at has the reference's samples per pixel: so FLIP sees what the tracer
//     does, and not how finely it samples.
//  3. The reference is direct, certified, of the same rays; its cost is not plotted.
#pragma once

#include <atomic>
#include <functional>

#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"
#include "render/trade/trade.h"

namespace facetless {

inline constexpr double kCheapMs = 1000;
inline constexpr int kRepetitions = 5;

struct TradeViewOptions {
  Execution execution;
  const std::atomic<bool>* budget = nullptr;  // as execution.cancel, for timed runs alone; null: that itself
};

struct TradeReference {
  Camera camera;
  View view;                         // its samples are of the pixel centres, its image is antialiased
  int samples = 1;                   // per pixel, of the image
  std::uint64_t outline_pixels = 0;  // hit, beside one that is not
  double mm_per_pixel = 0;           // at the camera's target
  double floor_mm = 0;               // what the reference does not know itself
};

// The samples per pixel that a picture of this size is given: 16, or fewer where that would be more than
// kMostPictureSamples.
inline constexpr std::uint64_t kMostPictureSamples = std::uint64_t{1} << 26;
int PictureSamples(int width_px, int height_px);

// Errors: those of RenderView.
Result<TradeReference> MeasureReference(const Scene& scene, const Camera& camera,
                                        const TradeViewOptions& options);

// A point with the numbers of a view and its errors. What is paid once per model the caller adds:
// convert_ms, scene_ms, make_ms, mesh_ms, build_ms, mesher_peak_bytes; CompleteCosts then forms the sums.
// `picture`: the same setting without the budget's limits, of which the antialiased picture is made. Errors:
// those of RenderView and ComputeDifference.
Result<TradePoint> MeasurePoint(const Representation& timed, const Representation& picture,
                                const Model& model, const TradeReference& reference,
                                const TradeSetting& setting, const TradeViewOptions& options);
void CompleteCosts(TradePoint& point);

// The median time of `work` by law 1, in ms.
double MedianMs(const std::function<void()>& work);

}  // namespace facetless
