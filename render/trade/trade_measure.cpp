#include "render/trade/trade_measure.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "render/base/stopwatch.h"
#include "render/nurbs/leaf.h"

namespace facetless {
namespace {

bool Hit(const SampleBuffer& samples, int x, int y) {
  return x >= 0 && y >= 0 && x < samples.width && y < samples.height &&
         samples.depth[static_cast<std::size_t>(y) * samples.width + x] != INFINITY;
}

std::uint64_t OutlinePixels(const SampleBuffer& samples) {
  std::uint64_t count = 0;
  for (int y = 0; y < samples.height; ++y)
    for (int x = 0; x < samples.width; ++x)
      count += Hit(samples, x, y) && !(Hit(samples, x - 1, y) && Hit(samples, x + 1, y) &&
                                       Hit(samples, x, y - 1) && Hit(samples, x, y + 1));
  return count;
}

// The options of a timed run with one sample per pixel.
ViewOptions TimedOptions(const TradeViewOptions& options) {
  ViewOptions view;
  view.samples = 1;
  view.execution = options.execution;
  if (options.budget != nullptr) view.execution.cancel = options.budget;
  return view;
}

// The options of the antialiased picture, which no budget limits.
ViewOptions PictureOptions(int samples, const TradeViewOptions& options) {
  ViewOptions view;
  view.samples = samples;
  view.uniform_samples = true;  // two settings may refine different pixels, and that is not what is measured
  view.execution = options.execution;
  return view;
}

// The times of one run.
struct Times {
  double leaves_ms = 0, trace_ms = 0, shade_ms = 0;
  std::uint64_t peak_bytes = 0;
  double total() const { return leaves_ms + trace_ms + shade_ms; }
};

// Repeats `run`, which returns Result<Times>, by law 1 of the header, and stores the median in `point`.
template <typename Run>
Result<void> Repeat(const Run& run, TradePoint& point) {
  const Stopwatch stopwatch;
  Result<Times> first = run();
  if (!first.ok()) return first.error();
  std::vector<Times> runs;
  if (stopwatch.Milliseconds() < kCheapMs) {
    for (int i = 0; i < kRepetitions; ++i) {
      Result<Times> again = run();
      // The budget is for one run, and the first was within it, so the runs so far are enough.
      if (!again.ok() && again.error().code == ErrorCode::kCancelled) break;
      if (!again.ok()) return again.error();
      runs.push_back(again.value());
    }
    if (runs.empty()) runs.push_back(first.value());
  } else {
    runs.push_back(first.value());
  }
  point.repetitions = static_cast<int>(runs.size());
  std::sort(runs.begin(), runs.end(), [](const Times& a, const Times& b) { return a.total() < b.total(); });
  const Times& median = runs[runs.size() / 2];
  point.fastest_ms = runs.front().total();
  point.slowest_ms = runs.back().total();
  point.leaves_ms = median.leaves_ms;
  point.trace_ms = median.trace_ms;
  point.shade_ms = median.shade_ms;
  point.tracer_peak_bytes = median.peak_bytes;
  return {};
}

// Computes the errors from the pixel-centre samples and the antialiased picture.
Result<void> StoreErrors(const TradeReference& reference, const SampleBuffer& samples, const Image8& image,
                         const Model& model, TradePoint& point) {
  const Result<Difference> compared = ComputeDifference({reference.view.samples,
                                                         samples,
                                                         reference.view.image,
                                                         image,
                                                         reference.view.frame,
                                                         model,
                                                         /*faces_known=*/true,
                                                         /*noise_mm=*/0,
                                                         {}});
  if (!compared.ok()) return compared.error();
  const Difference& difference = compared.value();
  point.depth_mm = difference.depth_mm;
  point.deviation_mm = difference.deviation_mm;
  point.silhouette = difference.silhouette;
  point.silhouette_offset_px = static_cast<double>(difference.silhouette.pixels) /
                               static_cast<double>(std::max<std::uint64_t>(reference.outline_pixels, 1));
  point.flip_mean = difference.color.flip_mean;
  point.flip_p95 = difference.color.flip_p95;
  point.deviation_px_scale = 1 / reference.mm_per_pixel;
  return {};
}

}  // namespace

int PictureSamples(int width_px, int height_px) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width_px) * static_cast<std::uint64_t>(height_px);
  for (const int samples : {16, 4})
    if (pixels * static_cast<std::uint64_t>(samples) <= kMostPictureSamples) return samples;
  return 1;
}

Result<TradeReference> MeasureReference(const Scene& scene, const Camera& camera,
                                        const TradeViewOptions& options) {
  TradeReference reference;
  reference.camera = camera;
  reference.samples = PictureSamples(camera.width_px, camera.height_px);
  DirectOptions direct;
  direct.accuracy.precision = Precision::kCertified;
  Result<View> view = RenderView(ExactSurfaces(scene, direct), scene.model(), camera,
                                 PictureOptions(reference.samples, options));
  if (!view.ok()) return view.error();
  reference.view = std::move(view).value();
  reference.outline_pixels = OutlinePixels(reference.view.samples);
  const CameraFrame& frame = reference.view.frame;
  const bool perspective = camera.projection == Projection::kPerspective;
  reference.mm_per_pixel =
      std::max(frame.pixel_x, frame.pixel_y) * (perspective ? Length(camera.target - camera.eye) : 1.0);
  // A certified root is known to the solver's tolerance, in the parameters of a leaf that is no larger than
  // the model. The factor 4 covers the rounding of the depth.
  reference.floor_mm = 4 * kDoubleArithmetic.tolerance * scene.model().Diagonal();
  return reference;
}

Result<TradePoint> MeasurePoint(const Representation& timed, const Representation& picture,
                                const Model& model, const TradeReference& reference,
                                const TradeSetting& setting, const TradeViewOptions& options) {
  TradePoint point;
  point.setting = setting;
  const auto run = [&]() -> Result<Times> {
    const Result<View> view = RenderView(timed, model, reference.camera, TimedOptions(options));
    if (!view.ok()) return view.error();
    if (view.value().direct) point.leaves = view.value().direct->leaves;
    const TraceCounters& counters = view.value().counters;
    return Times{counters.prepare_ms, counters.trace_ms, view.value().shade_ms, view.value().peak_bytes};
  };
  if (Result<void> repeated = Repeat(run, point); !repeated.ok()) return repeated.error();

  // Make the picture, and compute the errors.
  const Result<View> view =
      RenderView(picture, model, reference.camera, PictureOptions(reference.samples, options));
  if (!view.ok()) return view.error();
  point.picture_ms = view.value().color_ms + view.value().shade_ms;
  if (Result<void> stored = StoreErrors(reference, view.value().samples, view.value().image, model, point);
      !stored.ok())
    return stored.error();
  return point;
}

void CompleteCosts(TradePoint& point) {
  point.model_ms = point.mesh_ms + point.build_ms + point.convert_ms + point.scene_ms + point.make_ms;
  point.prepare_ms = point.model_ms + point.leaves_ms;
  point.total_ms = point.prepare_ms + point.trace_ms + point.shade_ms;
  point.peak_bytes = std::max(point.mesher_peak_bytes, point.tracer_peak_bytes);
}

double MedianMs(const std::function<void()>& work) {
  const auto run = [&] {
    const Stopwatch stopwatch;
    work();
    return stopwatch.Milliseconds();
  };
  const double first = run();
  if (!(first < kCheapMs)) return first;
  std::vector<double> times;
  for (int i = 0; i < kRepetitions; ++i) times.push_back(run());
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

}  // namespace facetless
