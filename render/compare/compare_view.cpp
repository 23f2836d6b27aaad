#include "render/compare/compare_view.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "render/trace/parallel.h"

namespace facetless {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kMaxSamples = 64;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::uint64_t BufferBytes(const SampleBuffer& samples) {
  return samples.depth.size() * sizeof(double) + samples.normal.size() * sizeof(samples.normal[0]) +
         samples.face.size() * sizeof(std::uint32_t) + samples.uv.size() * sizeof(std::array<double, 2>) +
         samples.certificate.size() * sizeof(Certificate) + samples.doubt.size() +
         samples.depth_error.size() * sizeof(float);
}

std::uint64_t FilmBytes(const SampleBuffer& samples) {
  return samples.size() * sizeof(std::array<float, 4>);
}

Result<void> CheckOptions(const ViewOptions& options) {
  if (options.samples < 1 || options.samples > kMaxSamples)
    return Error{ErrorCode::kBadUsage, std::to_string(options.samples) + " samples per pixel; 1 to " +
                                           std::to_string(kMaxSamples) + " can be taken"};
  if (options.threads < 0) return Error{ErrorCode::kBadUsage, "the number of threads must not be negative"};
  return {};
}

// Shades, resolves and encodes.
Result<Image8> Develop(const SampleBuffer& samples, const CameraFrame& frame,
                       const std::vector<Color>& colors, SampleGrid grid, const ViewOptions& options) {
  ShadeOptions shade;
  shade.background = options.background;
  shade.edges = options.edges;
  shade.samples_x = grid.x;
  shade.samples_y = grid.y;
  shade.threads = options.threads;
  Result<Film> film = Shade(samples, frame, colors, shade);
  if (!film.ok()) return film.error();
  std::optional<Result<Image8>> image;
  RunWithThreads(options.threads, [&] {
    const Result<Film> resolved = Resolve(std::move(film).value(), grid.x, grid.y);
    image = resolved.ok() ? Encode(resolved.value()) : Result<Image8>(resolved.error());
  });
  return *std::move(image);
}

// What RenderView makes, and the samples of the colour pass, which the foreign mesh's colours come from.
struct DirectPasses {
  DirectView view;
  SampleBuffer color_samples;  // empty where the pixel-centre pass is the colour pass

  const SampleBuffer& color() const { return color_samples.size() > 0 ? color_samples : view.samples; }
};

Result<DirectPasses> RunDirect(const Scene& scene, const Camera& camera, const std::vector<Color>& colors,
                               const ViewOptions& options) {
  const Clock::time_point start = Clock::now();
  DirectPasses passes;
  DirectView& view = passes.view;
  view.grid = GridOf(options.samples);

  // The pixel-centre pass.
  DirectOptions trace;
  trace.precision = options.precision;
  trace.max_bytes = options.max_bytes;
  trace.threads = options.threads;
  trace.newton_tolerance = options.newton_tolerance;
  trace.uv = options.uv;
  trace.depth_error = options.depth_error;
  trace.audit = options.audit;
  trace.cancel = options.cancel;
  Result<DirectResult> traced = TraceDirect(scene, camera, trace);
  if (!traced.ok()) return traced.error();
  view.frame = traced.value().frame;
  view.samples = std::move(traced.value().samples);
  view.stats = std::move(traced.value().stats);
  for (std::uint32_t id : view.stats.unseen_faces)
    view.unseen_names.push_back(scene.model().PlacedFaceName(id));
  view.peak_bytes = view.stats.scene_bytes + BufferBytes(view.samples) + FilmBytes(view.samples);

  // The colour pass.
  CameraFrame color_frame = view.frame;
  if (options.samples > 1) {
    const Clock::time_point color_start = Clock::now();
    trace.uv = trace.depth_error = trace.audit = false;
    Result<DirectResult> color = TraceDirect(scene, camera.Supersampled(view.grid.x, view.grid.y), trace);
    if (!color.ok()) return color.error();
    color_frame = color.value().frame;
    passes.color_samples = std::move(color.value().samples);
    view.color_ms = MillisecondsSince(color_start);
    view.peak_bytes =
        std::max(view.peak_bytes, color.value().stats.scene_bytes + BufferBytes(view.samples) +
                                      BufferBytes(passes.color_samples) + FilmBytes(passes.color_samples));
  }

  // Light.
  const Clock::time_point shade_start = Clock::now();
  Result<Image8> image = Develop(passes.color(), color_frame, colors, view.grid, options);
  if (!image.ok()) return image.error();
  view.image = std::move(image).value();
  view.shade_ms = MillisecondsSince(shade_start);
  view.total_ms = MillisecondsSince(start);
  return passes;
}

// For a mesh that names no faces: those that the direct image shows at the same sample, else the one it shows most often.
PerSample<std::uint32_t> BorrowFaces(const SampleBuffer& direct, const SampleBuffer& baseline) {
  std::map<std::uint32_t, std::size_t> counts;
  for (std::uint32_t face : direct.face)
    if (face != kNoIndex) ++counts[face];
  std::uint32_t commonest = 0;
  std::size_t most = 0;
  for (const auto& [face, count] : counts)
    if (count > most) {
      commonest = face;
      most = count;
    }
  PerSample<std::uint32_t> faces = baseline.face;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (faces[i] != kNoIndex) faces[i] = direct.face[i] != kNoIndex ? direct.face[i] : commonest;
  return faces;
}

// `direct` lends its faces to a foreign mesh; null for one that names its own.
Result<BaselineView> RunBaseline(const BaselineScene& scene, const Camera& camera, const DirectPasses* direct,
                                 const std::vector<Color>& colors, const ViewOptions& options) {
  const Clock::time_point start = Clock::now();
  const SampleGrid grid = GridOf(options.samples);
  BaselineView view;

  // The pixel-centre pass.
  const BaselineOptions trace{options.threads, options.cancel};
  Result<BaselineResult> traced = TraceBaseline(scene, camera, trace);
  if (!traced.ok()) return traced.error();
  view.samples = std::move(traced.value().samples);
  view.stats = traced.value().stats;
  const std::uint64_t scene_bytes = scene.mesh_bytes() + scene.bvh_peak_bytes();
  view.peak_bytes = scene_bytes + BufferBytes(view.samples) + FilmBytes(view.samples);

  // The colour pass.
  CameraFrame color_frame = traced.value().frame;
  SampleBuffer color = view.samples;
  if (options.samples > 1) {
    const Clock::time_point color_start = Clock::now();
    Result<BaselineResult> fine = TraceBaseline(scene, camera.Supersampled(grid.x, grid.y), trace);
    if (!fine.ok()) return fine.error();
    color_frame = fine.value().frame;
    color = std::move(fine.value().samples);
    view.color_ms = MillisecondsSince(color_start);
    view.peak_bytes = scene_bytes + BufferBytes(view.samples) + BufferBytes(color) + FilmBytes(color);
  }

  // Light.
  const Clock::time_point shade_start = Clock::now();
  if (direct != nullptr) color.face = BorrowFaces(direct->color(), color);
  Result<Image8> image = Develop(color, color_frame, colors, grid, options);
  if (!image.ok()) return image.error();
  view.image = std::move(image).value();
  view.shade_ms = MillisecondsSince(shade_start);
  view.total_ms = MillisecondsSince(start);
  return view;
}

// The difference of two views that are there, as numbers and as a picture.
Result<void> CompareViews(const Model& model, const BaselineScene& baseline, const ViewOptions& options,
                          ViewComparison& comparison) {
  Result<Difference> difference =
      ComputeDifference({comparison.direct.samples, comparison.baseline.samples, comparison.direct.image,
                         comparison.baseline.image, comparison.direct.frame, model,
                         baseline.mesh().from_model, baseline.noise_mm(), options.color});
  if (!difference.ok()) return difference.error();
  comparison.difference = std::move(difference).value();
  Result<DifferencePicture> picture =
      DrawDifference(comparison.direct.samples, comparison.baseline.samples, comparison.direct.frame,
                     comparison.difference, options.picture);
  if (!picture.ok()) return picture.error();
  comparison.picture = std::move(picture).value();
  return {};
}

Error OutOfMemory(const Camera& camera) {
  return {ErrorCode::kLimitExceeded, "view '" + camera.name + "': its pictures do not fit into memory"};
}

}  // namespace

SampleGrid GridOf(int samples) {
  SampleGrid grid{samples, 1};
  for (int y = 1; y * y <= samples; ++y)
    if (samples % y == 0) grid = {samples / y, y};
  return grid;
}

Result<DirectView> RenderView(const Scene& scene, const Camera& camera, const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  try {
    Result<DirectPasses> passes =
        RunDirect(scene, camera, FaceColors(scene.model(), options.coloring), options);
    if (!passes.ok()) return passes.error();
    return std::move(passes).value().view;
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

Result<BaselineView> RenderMesh(const BaselineScene& baseline, const Model& model, const Camera& camera,
                                const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  if (!baseline.mesh().from_model)
    return Error{ErrorCode::kBadUsage, "a mesh of another program has no face colours to be drawn in alone"};
  try {
    return RunBaseline(baseline, camera, nullptr, FaceColors(model, options.coloring), options);
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

Result<ViewComparison> CompareView(const Scene& scene, const BaselineScene& baseline, const Camera& camera,
                                   const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  try {
    // Trace both.
    ViewComparison comparison;
    comparison.camera = camera;
    const std::vector<Color> colors = FaceColors(scene.model(), options.coloring);
    Result<DirectPasses> direct = RunDirect(scene, camera, colors, options);
    if (!direct.ok()) return direct.error();
    Result<BaselineView> meshed = RunBaseline(
        baseline, camera, baseline.mesh().from_model ? nullptr : &direct.value(), colors, options);
    if (!meshed.ok()) return meshed.error();
    comparison.direct = std::move(direct.value().view);
    comparison.baseline = std::move(meshed).value();

    // Compare.
    const Clock::time_point start = Clock::now();
    Result<void> compared;
    RunWithThreads(options.threads,
                   [&] { compared = CompareViews(scene.model(), baseline, options, comparison); });
    if (!compared.ok()) return compared.error();
    comparison.difference_ms = MillisecondsSince(start);
    return comparison;
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

}  // namespace facetless
