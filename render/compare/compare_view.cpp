#include "render/compare/compare_view.h"

#include <algorithm>
#include <map>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "render/base/execution.h"
#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/compare/representation.h"
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
  if (options.execution.threads < 0)
    return Error{ErrorCode::kBadUsage, "the number of threads must not be negative"};
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
  shade.execution = options.execution;
  Result<Film> film = inspection != nullptr ? Draw(subject.model, exposure.scene, exposure.samples,
                                                   exposure.frame, *inspection, shade)
                                            : Shade(exposure.samples, exposure.frame, subject.colors, shade);
  if (!film.ok()) return film.error();
  std::optional<Film> behind;
  if (exposure.behind != nullptr && inspection == nullptr) {
    Result<Film> shaded = Shade(*exposure.behind, exposure.frame, subject.colors, shade);
    if (!shaded.ok()) return shaded.error();
    behind = std::move(shaded).value();
  }
  std::optional<Result<Image8>> image;
  RunWithThreads(options.execution.threads, [&] {
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
      Measure(model, scene, centres, frame, options.inspection, options.execution);
  if (!measured.ok()) return measured.error();
  return std::optional<InspectionView>(std::move(measured).value());
}

const InspectionView* Address(const std::optional<InspectionView>& view) {
  return view ? &*view : nullptr;
}

// One representation from one camera.
struct RepresentedView {
  TracedView traced;           // the pixel-centre pass
  SampleBuffer color_samples;  // empty where the pixel-centre pass is the colour pass
  Image8 image;
  std::optional<InspectionView> inspection;
  std::vector<ViewLine> lines;
  double color_ms = 0, lines_ms = 0, shade_ms = 0, total_ms = 0;
  std::uint64_t peak_bytes = 0;

  const SampleBuffer& color() const { return color_samples.size() > 0 ? color_samples : traced.samples; }
};

// For a mesh that names no faces: those that the direct image shows at the same sample, else the one it shows
// most often.
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

// Makes the view of one representation.
class ViewMaker {
 public:
  ViewMaker(const Representation& representation, const Camera& camera, const Subject& subject,
            const ViewOptions& options)
      : representation_(representation),
        camera_(camera),
        subject_(subject),
        options_(options),
        grid_(GridOf(options.samples)) {}

  // `reference`: a view whose lines are drawn, and which lends its faces to samples that name none; null: the
  // representation finds its own lines.
  Result<RepresentedView> Make(const RepresentedView* reference) {
    const Stopwatch stopwatch;
    if (auto done = TraceCentres(); !done.ok()) return done.error();
    if (auto done = TraceColors(); !done.ok()) return done.error();
    if (auto done = TraceBehind(); !done.ok()) return done.error();
    if (auto done = FindOwnLines(); !done.ok()) return done.error();
    if (auto done = Light(reference); !done.ok()) return done.error();
    view_.total_ms = stopwatch.Milliseconds();
    return std::move(view_);
  }

 private:
  Result<void> TraceCentres() {
    Result<TracedView> traced = representation_.Trace(camera_,
                                                      {.uv = options_.uv || WantsUv(options_.inspection.kind),
                                                       .depth_error = options_.depth_error,
                                                       .audit = options_.audit},
                                                      options_.execution);
    if (!traced.ok()) return traced.error();
    view_.traced = std::move(traced).value();
    color_frame_ = view_.traced.frame;
    const SampleBuffer& samples = view_.traced.samples;
    view_.peak_bytes = view_.traced.structure_bytes + BufferBytes(samples) + FilmBytes(samples);
    return {};
  }

  // The report's certificates are those of the pixel centres.
  TraceRequest ColorRequest() const {
    return {.uv = NeedsExactSurface(options_.inspection.kind), .certificates = false};
  }

  Result<void> TraceColors() {
    if (options_.samples == 1) return {};
    const Stopwatch stopwatch;
    Result<TracedView> color =
        representation_.Trace(camera_.Supersampled(grid_.x, grid_.y), ColorRequest(), options_.execution);
    if (!color.ok()) return color.error();
    color_frame_ = color.value().frame;
    view_.color_samples = std::move(color.value().samples);
    view_.color_ms = stopwatch.Milliseconds();
    view_.peak_bytes =
        std::max(view_.peak_bytes, color.value().structure_bytes + BufferBytes(view_.traced.samples) +
                                       BufferBytes(view_.color_samples) + FilmBytes(view_.color_samples));
    return {};
  }

  // What lies behind transparent faces. Those of a representation that names no faces are not known.
  Result<void> TraceBehind() {
    if (subject_.transparent.empty() || !representation_.names_faces()) return {};
    const Stopwatch stopwatch;
    Result<TracedView> seen = representation_.Trace(
        camera_.Supersampled(grid_.x, grid_.y), {.certificates = false, .leave_out = &subject_.transparent},
        options_.execution);
    if (!seen.ok()) return seen.error();
    behind_ = std::move(seen.value().samples);
    view_.color_ms += stopwatch.Milliseconds();
    return {};
  }

  Result<void> FindOwnLines() {
    const Scene* scene = representation_.exact();
    if (scene == nullptr || (options_.lines == LineMode::kNone && !options_.find_lines)) return {};
    const Stopwatch stopwatch;
    view_.lines = FindLines(*scene, camera_, view_.traced.frame, view_.color(), color_frame_,
                            {.sections = options_.sections, .execution = options_.execution});
    if (options_.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while finding lines"};
    std::erase_if(view_.lines, [&](const ViewLine& line) {
      return !line.visible && (options_.lines != LineMode::kHidden || line.kind == LineClass::kSeam ||
                               line.kind == LineClass::kSmooth);
    });
    view_.lines_ms = stopwatch.Milliseconds();
    return {};
  }

  Result<void> Light(const RepresentedView* reference) {
    const Stopwatch stopwatch;
    auto inspected = Inspected(subject_.model, representation_.exact(), view_.traced.samples,
                               view_.traced.frame, options_);
    if (!inspected.ok()) return inspected.error();
    view_.inspection = std::move(inspected).value();
    std::optional<SampleBuffer> borrowed;
    if (reference != nullptr && !representation_.names_faces()) {
      borrowed = view_.color();
      borrowed->face = BorrowFaces(reference->color(), *borrowed);
    }
    const SampleBuffer& color = borrowed ? *borrowed : view_.color();
    const std::vector<ViewLine>& lines = reference != nullptr ? reference->lines : view_.lines;
    Result<Image8> image = Develop(
        {color, color_frame_, grid_, representation_.exact(), lines, behind_.size() > 0 ? &behind_ : nullptr},
        subject_, Address(view_.inspection), options_);
    if (!image.ok()) return image.error();
    view_.image = std::move(image).value();
    view_.shade_ms = stopwatch.Milliseconds();
    return {};
  }

  const Representation& representation_;
  const Camera& camera_;
  const Subject& subject_;
  const ViewOptions& options_;
  const SampleGrid grid_;
  RepresentedView view_;
  CameraFrame color_frame_;  // of the colour pass
  SampleBuffer behind_;      // empty where nothing is transparent
};

ExactSurfaces ExactSurfacesOf(const Scene& scene, const ViewOptions& options) {
  DirectOptions trace;
  trace.precision = options.precision;
  trace.check = options.check;
  trace.max_bytes = options.max_bytes;
  trace.newton_tolerance = options.newton_tolerance;
  trace.sections = options.sections;
  return ExactSurfaces(scene, std::move(trace));
}

Triangles TrianglesOf(const BaselineScene& scene, const Subject& subject, const ViewOptions& options) {
  return Triangles(scene, options.sections, subject.solids ? &*subject.solids : nullptr, options.max_bytes);
}

DirectView DirectViewOf(RepresentedView view, const Model& model, const ViewOptions& options) {
  DirectView direct;
  direct.frame = view.traced.frame;
  direct.samples = std::move(view.traced.samples);
  direct.stats = *std::move(view.traced.direct);
  for (std::uint32_t id : direct.stats.unseen_faces) direct.unseen_names.push_back(model.PlacedFaceName(id));
  direct.image = std::move(view.image);
  direct.inspection = std::move(view.inspection);
  direct.grid = GridOf(options.samples);
  direct.lines = std::move(view.lines);
  direct.color_ms = view.color_ms;
  direct.lines_ms = view.lines_ms;
  direct.shade_ms = view.shade_ms;
  direct.total_ms = view.total_ms;
  direct.peak_bytes = view.peak_bytes;
  return direct;
}

BaselineView BaselineViewOf(RepresentedView view) {
  BaselineView baseline;
  baseline.samples = std::move(view.traced.samples);
  baseline.stats = *view.traced.baseline;
  baseline.image = std::move(view.image);
  baseline.inspection = std::move(view.inspection);
  baseline.color_ms = view.color_ms;
  baseline.shade_ms = view.shade_ms;
  baseline.total_ms = view.total_ms;
  baseline.peak_bytes = view.peak_bytes;
  return baseline;
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
    const Subject subject(scene.model(), options);
    Result<RepresentedView> view =
        ViewMaker(ExactSurfacesOf(scene, options), camera, subject, options).Make(nullptr);
    if (!view.ok()) return view.error();
    return DirectViewOf(std::move(view).value(), scene.model(), options);
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
    const Subject subject(model, options);
    Result<RepresentedView> view =
        ViewMaker(TrianglesOf(baseline, subject, options), camera, subject, options).Make(nullptr);
    if (!view.ok()) return view.error();
    return BaselineViewOf(std::move(view).value());
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
    Result<RepresentedView> exact =
        ViewMaker(ExactSurfacesOf(scene, options), camera, subject, options).Make(nullptr);
    if (!exact.ok()) return exact.error();
    Result<RepresentedView> meshed =
        ViewMaker(TrianglesOf(baseline, subject, options), camera, subject, options).Make(&exact.value());
    if (!meshed.ok()) return meshed.error();
    comparison.direct = DirectViewOf(std::move(exact).value(), scene.model(), options);
    comparison.baseline = BaselineViewOf(std::move(meshed).value());

    // Compare.
    const Stopwatch stopwatch;
    Result<void> compared;
    RunWithThreads(options.execution.threads,
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
