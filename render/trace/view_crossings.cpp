#include "render/trace/view_crossings.h"

#include <optional>
#include <utility>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/kernels/dispatch.h"
#include "render/trace/crossings.h"
#include "render/trace/prepare.h"
#include "render/trace/tile_tracer.h"

namespace facetless {
namespace {

// What a thread needs, and its counters.
struct Worker {
  Worker(const TraceShared& shared, TileKernel kernel)
      : tracer(shared, kernel, /*certify=*/false), view_width(shared.camera.width_px) {}

  // Traces a tile, and lists the crossings of its samples row by row.
  void Trace(const PreparedView& view, int index) {
    found.clear();
    tracer.Trace(index, &found);
    SortCrossings(view, &found);
    crossings.clear();
    const LeafSpans leaves = view.tiles->leaves();
    const std::size_t samples = static_cast<std::size_t>(tracer.rows() * tracer.columns());
    first.assign(samples + 1, 0);
    doubts.assign(samples, 0);
    // The samples of a tile are not consecutive in the image, but their order is that of the sorted crossings.
    auto next = found.begin();
    for (int i = 0; i < tracer.rows(); ++i)
      for (int j = 0; j < tracer.columns(); ++j) {
        const std::size_t k = static_cast<std::size_t>(i * tracer.columns() + j);
        const std::uint32_t sample =
            static_cast<std::uint32_t>((tracer.row() + i) * view_width + tracer.column() + j);
        if (!tracer.empty()) doubts[k] = tracer.doubt[static_cast<std::size_t>(i * kTileSize + j)];
        for (; next != found.end() && next->sample == sample; ++next) {
          crossings.push_back(
              {next->hit.depth, next->hit.error, leaves.Header(next->leaf).placed_face, next->doubt});
          doubts[k] |= next->doubt;
        }
        first[k + 1] = static_cast<std::uint32_t>(crossings.size());
        in_doubt += doubts[k] != 0;
      }
    total += crossings.size();
  }

  TileTracer tracer;
  int view_width;
  std::vector<Crossing> found;
  std::vector<RayCrossing> crossings;
  std::vector<std::uint32_t> first;
  std::vector<std::uint8_t> doubts;
  std::uint64_t total = 0, in_doubt = 0;
};

Result<CrossingStats> Visit(const Scene& scene, const Camera& camera, const ExactTraceOptions& accuracy,
                            const Execution& execution,
                            const std::function<void(const TileCrossings&)>& visit) {
  const Stopwatch preparing;
  const Result<CameraFrame> frame = MakeFrame(camera, scene.model().Diagonal());
  if (!frame.ok()) return frame.error();
  const Result<Kernels>& kernels = ActiveKernels();
  if (!kernels.ok()) return kernels.error();
  DirectOptions options;
  options.execution = execution;
  options.accuracy = accuracy;
  const TileKernel kernel =
      accuracy.precision == Precision::kFast ? kernels.value().trace_tile_float : kernels.value().trace_tile;
  const Result<PreparedView> view = PrepareView(scene.data(), camera, frame.value(), options);
  if (!view.ok()) return view.error();
  const TraceShared shared(scene.data(), view.value(), camera, frame.value());
  CrossingStats stats;
  stats.prepare_ms = preparing.Milliseconds();
  const Stopwatch tracing;
  PerThread<Worker> workers([&] { return Worker(shared, kernel); });
  const int tiles_x = view.value().tiles->tiles_x(), tiles_y = view.value().tiles->tiles_y();
  ParallelFor(0, tiles_x, [&](int tile_x) {
    for (int tile_y = 0; tile_y < tiles_y && !execution.cancelled(); ++tile_y) {
      Worker& worker = workers.local();
      worker.Trace(view.value(), tile_y * tiles_x + tile_x);
      visit({worker.tracer.column(), worker.tracer.row(), worker.tracer.columns(), worker.tracer.rows(),
             tile_x, tile_y + 1 == tiles_y, worker.crossings, worker.first, worker.doubts});
    }
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while tracing"};
  stats.trace_ms = tracing.Milliseconds();
  stats.rays = static_cast<std::uint64_t>(camera.width_px) * static_cast<std::uint64_t>(camera.height_px);
  stats.bytes = view.value().bytes();
  for (const Worker& worker : workers) {
    stats.crossings += worker.total;
    stats.rays_in_doubt += worker.in_doubt;
    stats.bytes += worker.tracer.bitmap_bytes();
  }
  return stats;
}

}  // namespace

Result<CrossingStats> VisitCrossings(const Scene& scene, const Camera& camera,
                                     const ExactTraceOptions& accuracy, const Execution& execution,
                                     const std::function<void(const TileCrossings&)>& visit) {
  std::optional<Result<CrossingStats>> result;
  RunWithThreads(execution.threads, [&] { result = Visit(scene, camera, accuracy, execution, visit); });
  return *std::move(result);
}

}  // namespace facetless
