// Measuring one point of speed against accuracy.
//
//  1. Times belong to a view with one sample per pixel. A run of less than kCheapMs is a warm-up; it is
//     followed by kRepetitions runs, and the run with the median total is reported. A longer run is reported
//     directly.
//  2. The picture for FLIP has the same number of samples per pixel as the reference, so that FLIP measures
//     the tracer and not the sampling.
//  3. The reference is the direct tracer, certified, with the same rays. Its cost is not plotted.
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
  const std::atomic<bool>* budget =
      nullptr;  // replaces execution.cancel for timed runs; null: execution.cancel is used
};

struct TradeReference {
  Camera camera;
  View view;                         // the samples are at pixel centres; the image is antialiased
  int samples = 1;                   // per pixel, of the image
  std::uint64_t outline_pixels = 0;  // hit pixels next to a pixel that is a miss
  double mm_per_pixel = 0;           // at the camera's target
  double floor_mm = 0;               // accuracy of the reference itself
};

// The samples per pixel of a picture of this size: 16, or fewer if the total would exceed
// kMostPictureSamples.
inline constexpr std::uint64_t kMostPictureSamples = std::uint64_t{1} << 26;
int PictureSamples(int width_px, int height_px);

// Measures the reference. Errors: the errors of RenderView.
Result<TradeReference> MeasureReference(const Scene& scene, const Camera& camera,
                                        const TradeViewOptions& options);

// Measures a point: the costs of the view, and its errors. The caller adds the costs that occur once per
// model (convert_ms, scene_ms, make_ms, mesh_ms, build_ms, mesher_peak_bytes) and then calls CompleteCosts,
// which computes the sums. `picture` is the same setting without the limits of the budget; the antialiased
// picture is made with it. Errors: the errors of RenderView and ComputeDifference.
Result<TradePoint> MeasurePoint(const Representation& timed, const Representation& picture,
                                const Model& model, const TradeReference& reference,
                                const TradeSetting& setting, const TradeViewOptions& options);
void CompleteCosts(TradePoint& point);

// The time of `work`, measured by law 1, ms.
double MedianMs(const std::function<void()>& work);

}  // namespace facetless
