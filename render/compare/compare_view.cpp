#include "render/compare/compare_view.h"

#include <algorithm>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/compare/see_through.h"
#include "render/lines/draw_lines.h"
#include "render/lines/view_lines.h"

namespace facetless {
namespace {

constexpr int kMaxSamples = 64;

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

// What pictures are made of, whoever traces it.
struct Subject {
  Subject(const Model& m, const ViewOptions& options) : model(m), colors(FaceColors(m, options.coloring)) {
    if (options.sections.empty()) {
      transparent = TransparentFaces(colors);
      return;
    }
    for (Color& color : colors) color.a = 1;
    solids.emplace(m);
    // A cap has its solid's commonest colour in the file, else that of one of its faces.
    std::vector<Color> caps;
    for (std::uint32_t solid = 0; solid < solids->stride(); ++solid) caps.push_back(solids->ColorOf(solid));
    if (options.coloring.source != ColorSource::kFile)
      for (std::uint32_t face = 0; face < colors.size(); ++face)
        if (const std::uint32_t solid = solids->SolidOf(face); solid != kNoIndex) caps[solid] = colors[face];
    for (std::size_t plane = 0; plane < options.sections.size(); ++plane)
      colors.insert(colors.end(), caps.begin(), caps.end());
  }
  const Model& model;
  std::vector<Color> colors;  // by placed face, then by cap
  std::vector<bool>
      transparent;  // by placed face; empty: none is, or sections would lose their solids without it
  std::optional<SectionSolids> solids;  // whose caps are shown; none where nothing is cut
};

// What a picture is made from: samples at the grid's resolution, and what they were traced with.
struct Exposure {
  const SampleBuffer& samples;
  const CameraFrame& frame;
  SampleGrid grid;
  const Scene* scene;  // null for a mesh
  const std::vector<ViewLine>& lines;
  const SampleBuffer* behind;  // what transparent faces hide, for the same rays; null: nothing is transparent
};

// Shades, resolves, draws lines and encodes. `inspection` is null for the studio's light.
Result<Image8> Develop(const Exposure& exposure, const Subject& subject, const InspectionView* inspection,
                       const ViewOptions& options) {
  ShadeOptions shade;
  if (subject.solids) {
    shade.first_cap = subject.solids->first_cap();
    shade.cap_stride = subject.solids->stride();
  }
  shade.background = options.background;
  shade.edges = options.edges;
  shade.samples_x = exposure.grid.x;
  shade.samples_y = exposure.grid.y;
  shade.threads = options.threads;
  Result<Film> film = inspection != nullptr ? Draw(subject.model, exposure.scene, exposure.samples,
                                                   exposure.frame, *inspection, shade, options.cancel)
                                            : Shade(exposure.samples, exposure.frame, subject.colors, shade);
  if (!film.ok()) return film.error();
  std::optional<Film> behind;
  if (exposure.behind != nullptr && inspection == nullptr) {
    Result<Film> shaded = Shade(*exposure.behind, exposure.frame, subject.colors, shade);
    if (!shaded.ok()) return shaded.error();
    behind = std::move(shaded).value();
  }
  std::optional<Result<Image8>> image;
  RunWithThreads(options.threads, [&] {
    if (behind) BlendOver(exposure.samples, subject.colors, *behind, &film.value());
    Result<Film> resolved = Resolve(std::move(film).value(), exposure.grid.x, exposure.grid.y);
    if (resolved.ok() && options.lines != LineMode::kNone) DrawLines(exposure.lines, &resolved.value());
    image = resolved.ok() ? Encode(resolved.value()) : Result<Image8>(resolved.error());
  });
  return *std::move(image);
}

// What the options' inspection finds at pixel centres; none for the studio.
Result<std::optional<InspectionView>> Inspected(const Model& model, const Scene* scene,
                                                const SampleBuffer& centres, const CameraFrame& frame,
                                                const ViewOptions& options) {
  if (options.inspection.kind == InspectionKind::kStudio) return std::optional<InspectionView>();
  Result<InspectionView> measured =
      Measure(model, scene, centres, frame, options.inspection, options.threads, options.cancel);
  if (!measured.ok()) return measured.error();
  return std::optional<InspectionView>(std::move(measured).value());
}

const InspectionView* Address(const std::optional<InspectionView>& view) {
  return view ? &*view : nullptr;
}

// What RenderView makes, and the samples of the colour pass, which the foreign mesh's colours come from.
struct DirectPasses {
  DirectView view;
  SampleBuffer color_samples;  // empty where the pixel-centre pass is the colour pass

  const SampleBuffer& color() const { return color_samples.size() > 0 ? color_samples : view.samples; }
};

Result<DirectPasses> RunDirect(const Scene& scene, const Camera& camera, const Subject& subject,
                               const ViewOptions& options) {
  const Stopwatch stopwatch;
  DirectPasses passes;
  DirectView& view = passes.view;
  view.grid = GridOf(options.samples);

  // The pixel-centre pass.
  DirectOptions trace;
  trace.precision = options.precision;
  trace.check = options.check;
  trace.max_bytes = options.max_bytes;
  trace.threads = options.threads;
  trace.newton_tolerance = options.newton_tolerance;
  trace.uv = options.uv || WantsUv(options.inspection.kind);
  trace.depth_error = options.depth_error;
  trace.audit = options.audit;
  trace.sections = options.sections;
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
    const Stopwatch color_watch;
    trace.uv = NeedsExactSurface(options.inspection.kind);
    trace.depth_error = trace.audit = false;
    trace.check = CheckLevel::kNone;  // the report's certificates are those of the pixel centres
    Result<DirectResult> color = TraceDirect(scene, camera.Supersampled(view.grid.x, view.grid.y), trace);
    if (!color.ok()) return color.error();
    color_frame = color.value().frame;
    passes.color_samples = std::move(color.value().samples);
    view.color_ms = color_watch.Milliseconds();
    view.peak_bytes =
        std::max(view.peak_bytes, color.value().stats.scene_bytes + BufferBytes(view.samples) +
                                      BufferBytes(passes.color_samples) + FilmBytes(passes.color_samples));
  }

  // What lies behind transparent faces.
  SampleBuffer behind;
  if (!subject.transparent.empty()) {
    const Stopwatch behind_watch;
    trace.uv = trace.depth_error = trace.audit = false;
    trace.leave_out = &subject.transparent;
    Result<DirectResult> seen = TraceDirect(scene, camera.Supersampled(view.grid.x, view.grid.y), trace);
    if (!seen.ok()) return seen.error();
    behind = std::move(seen.value().samples);
    view.color_ms += behind_watch.Milliseconds();
  }

  // Lines.
  if (options.lines != LineMode::kNone || options.find_lines) {
    const Stopwatch lines_watch;
    view.lines =
        FindLines(scene, camera, view.frame, passes.color(), color_frame,
                  {.sections = options.sections, .threads = options.threads, .cancel = options.cancel});
    if (options.cancel && options.cancel->load())
      return Error{ErrorCode::kCancelled, "cancelled while finding lines"};
    std::erase_if(view.lines, [&](const ViewLine& line) {
      return !line.visible && (options.lines != LineMode::kHidden || line.kind == LineClass::kSeam ||
                               line.kind == LineClass::kSmooth);
    });
    view.lines_ms = lines_watch.Milliseconds();
  }

  // Light.
  const Stopwatch shade_watch;
  auto inspected = Inspected(subject.model, &scene, view.samples, view.frame, options);
  if (!inspected.ok()) return inspected.error();
  view.inspection = std::move(inspected).value();
  Result<Image8> image = Develop(
      {passes.color(), color_frame, view.grid, &scene, view.lines, behind.size() > 0 ? &behind : nullptr},
      subject, Address(view.inspection), options);
  if (!image.ok()) return image.error();
  view.image = std::move(image).value();
  view.shade_ms = shade_watch.Milliseconds();
  view.total_ms = stopwatch.Milliseconds();
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
                                 const Subject& subject, const std::vector<ViewLine>& lines,
                                 const ViewOptions& options) {
  const Stopwatch stopwatch;
  const SampleGrid grid = GridOf(options.samples);
  BaselineView view;

  // The pixel-centre pass.
  const BaselineOptions trace{options.threads, options.cancel, options.sections,
                              subject.solids ? &*subject.solids : nullptr};
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
    const Stopwatch color_watch;
    Result<BaselineResult> fine = TraceBaseline(scene, camera.Supersampled(grid.x, grid.y), trace);
    if (!fine.ok()) return fine.error();
    color_frame = fine.value().frame;
    color = std::move(fine.value().samples);
    view.color_ms = color_watch.Milliseconds();
    view.peak_bytes = scene_bytes + BufferBytes(view.samples) + BufferBytes(color) + FilmBytes(color);
  }

  // What lies behind transparent faces. Those of a mesh of another program are not known.
  SampleBuffer behind;
  if (!subject.transparent.empty() && scene.mesh().from_model) {
    const Stopwatch behind_watch;
    const Mesh opaque = OpaqueMesh(scene.mesh(), subject.transparent);
    Result<BaselineScene> opaque_scene =
        BaselineScene::Build(opaque, options.threads, false, options.max_bytes);
    if (opaque_scene.ok()) {
      Result<BaselineResult> seen =
          TraceBaseline(opaque_scene.value(), camera.Supersampled(grid.x, grid.y), trace);
      if (!seen.ok()) return seen.error();
      behind = std::move(seen.value().samples);
    } else if (opaque_scene.error().code == ErrorCode::kNothingUsable) {
      behind.Resize(color.width, color.height);  // everything is transparent
    } else {
      return opaque_scene.error();
    }
    view.color_ms += behind_watch.Milliseconds();
  }

  // Light.
  const Stopwatch shade_watch;
  if (direct != nullptr) color.face = BorrowFaces(direct->color(), color);
  auto inspected = Inspected(subject.model, nullptr, view.samples, traced.value().frame, options);
  if (!inspected.ok()) return inspected.error();
  view.inspection = std::move(inspected).value();
  Result<Image8> image =
      Develop({color, color_frame, grid, nullptr, lines, behind.size() > 0 ? &behind : nullptr}, subject,
              Address(view.inspection), options);
  if (!image.ok()) return image.error();
  view.image = std::move(image).value();
  view.shade_ms = shade_watch.Milliseconds();
  view.total_ms = stopwatch.Milliseconds();
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

void NameCaps(const SectionSolids& solids, Difference* difference) {
  for (FaceDifference& face : difference->faces) {
    if (face.id < solids.first_cap()) continue;
    const std::uint32_t cap = face.id - solids.first_cap();
    face.name =
        "section " + std::to_string(cap / solids.stride()) + " of " + solids.Name(cap % solids.stride());
  }
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
    Result<DirectPasses> passes = RunDirect(scene, camera, Subject(scene.model(), options), options);
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
  if (Result<void> can = CheckMeshCanShow(options.inspection, true); !can.ok()) return can.error();
  try {
    return RunBaseline(baseline, camera, nullptr, Subject(model, options), {}, options);
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

Result<ViewComparison> CompareView(const Scene& scene, const BaselineScene& baseline, const Camera& camera,
                                   const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  if (Result<void> can = CheckMeshCanShow(options.inspection, baseline.mesh().from_model); !can.ok())
    return can.error();
  try {
    // Trace both.
    ViewComparison comparison;
    comparison.camera = camera;
    const Subject subject(scene.model(), options);
    Result<DirectPasses> direct = RunDirect(scene, camera, subject, options);
    if (!direct.ok()) return direct.error();
    Result<BaselineView> meshed =
        RunBaseline(baseline, camera, baseline.mesh().from_model ? nullptr : &direct.value(), subject,
                    direct.value().view.lines, options);
    if (!meshed.ok()) return meshed.error();
    comparison.direct = std::move(direct.value().view);
    comparison.baseline = std::move(meshed).value();

    // Compare.
    const Stopwatch stopwatch;
    Result<void> compared;
    RunWithThreads(options.threads,
                   [&] { compared = CompareViews(scene.model(), baseline, options, comparison); });
    if (!compared.ok()) return compared.error();
    if (subject.solids) NameCaps(*subject.solids, &comparison.difference);
    comparison.difference_ms = stopwatch.Milliseconds();
    return comparison;
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

}  // namespace facetless
