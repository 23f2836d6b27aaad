#include "render/compare/compare_view.h"

#include <algorithm>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "render/base/execution.h"
#include "render/base/parallel.h"
#include "render/base/stopwatch.h"
#include "render/compare/borrowed_faces.h"
#include "render/compare/see_through.h"
#include "render/lines/draw_lines.h"
#include "render/lines/view_lines.h"
#include "render/shade/contrast.h"

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
                                           std::to_string(kMaxSamples) + " are allowed"};
  if (options.execution.threads < 0)
    return Error{ErrorCode::kBadUsage, "the number of threads must not be negative"};
  if (options.light.any() && options.inspection.kind != InspectionKind::kStudio)
    return Error{ErrorCode::kBadUsage,
                 "an inspection has no light; leave out either --shade, or --shadows, --ambient-occlusion "
                 "and --material"};
  return {};
}

// The data that the pictures of all representations share.
struct Subject {
  Subject(const Model& m, const ViewOptions& options) : model(m), colors(FaceColors(m, options.coloring)) {
    if (options.sections.empty()) {
      transparent = TransparentFaces(colors);
      return;
    }
    for (Color& color : colors) color.a = 1;
    solids.emplace(m);
    // A cap has the commonest colour of its solid if the colours are those of the file; otherwise it has the
    // colour of one of the solid's faces.
    std::vector<Color> caps;
    for (std::uint32_t solid = 0; solid < solids->stride(); ++solid) caps.push_back(solids->ColorOf(solid));
    if (options.coloring.source != ColorSource::kFile)
      for (std::uint32_t face = 0; face < colors.size(); ++face)
        if (const std::uint32_t solid = solids->ClosedSolidOfFace(face); solid != kNoIndex)
          caps[solid] = colors[face];
    for (std::size_t plane = 0; plane < options.sections.size(); ++plane)
      colors.insert(colors.end(), caps.begin(), caps.end());
  }
  const Model& model;
  std::vector<Color> colors;  // by placed face, then by cap
  // By placed face. Empty if no face is transparent, or if there are sections, which need all faces of a
  // solid.
  std::vector<bool> transparent;
  std::optional<SectionSolids> solids;  // the solids whose caps are shown; empty without sections
};

// The input of a picture: samples at the grid's resolution, and what they were traced with.
struct Exposure {
  const SampleBuffer& samples;
  const CameraFrame& frame;
  SampleGrid grid;
  const Scene* scene;  // null for a mesh
  const std::vector<ViewLine>& lines;
  // What transparent faces hide, for the same rays; null if nothing is transparent.
  const SampleBuffer* behind;
  // The light of `samples` and of `behind`; null if no light was cast.
  const SampleLight* light = nullptr;
  const SampleLight* light_behind = nullptr;
};

ShadeOptions HowToShade(const Subject& subject, SampleGrid grid, const ViewOptions& options,
                        const SampleLight* light) {
  ShadeOptions shade;
  shade.light = light;
  shade.ground_up = RotateToUpAxis(options.up, {0, 0, 1});
  if (subject.solids) {
    shade.first_cap = subject.solids->first_cap();
    shade.cap_stride = subject.solids->stride();
  }
  shade.background = options.background;
  shade.edges = options.edges;
  shade.samples_x = grid.x;
  shade.samples_y = grid.y;
  shade.execution = options.execution;
  return shade;
}

// Shades the samples, resolves them to pixels, draws lines and encodes the image. `inspection` is null for
// the studio's light.
Result<Image8> Develop(const Exposure& exposure, const Subject& subject, const InspectionView* inspection,
                       const ViewOptions& options) {
  ShadeOptions shade = HowToShade(subject, exposure.grid, options, exposure.light);
  Result<Film> film = inspection != nullptr ? Draw(subject.model, exposure.scene, exposure.samples,
                                                   exposure.frame, *inspection, shade)
                                            : Shade(exposure.samples, exposure.frame, subject.colors, shade);
  if (!film.ok()) return film.error();
  std::optional<Film> behind;
  if (exposure.behind != nullptr && inspection == nullptr) {
    shade.light = exposure.light_behind;
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

// Returns the result of the inspection at pixel centres; empty for the studio's light.
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

// What the view of a candidate takes from the reference: its lines are drawn, and its faces stand in for
// those of samples that name none.
struct ReferenceView {
  const View& view;
  const SampleBuffer* all_samples;  // null if it has one sample per pixel, or was sampled adaptively
  const Refinement* refinement;     // null if it was not
};

// Chooses the pixels of a representation that are refined: those that the reference refines, and those with contrast
// among the colours of the centres. It shades the centres for that, and keeps the film.
class ContrastPicker final : public PixelPicker {
 public:
  // `faces`: the faces that the samples borrow; null if they name their own. `also`: null if there is no reference.
  // `lighter` casts the light of the centres; if it is null, no light is cast, and all light arrives.
  ContrastPicker(const Subject& subject, const ViewOptions& options, const BorrowedFaces* faces,
                 const PixelSet* also, ViewLighter* lighter)
      : subject_(subject), options_(options), faces_(faces), also_(also), lighter_(lighter) {}

  void Pick(const SampleBuffer& centres, const CameraFrame& frame, PixelSet* set) override {
    if (lighter_ != nullptr) {
      light_ = lighter_->Cast(centres, frame);
      if (!light_->ok()) return;
    }
    const Stopwatch stopwatch;
    std::optional<SampleBuffer> borrowed;
    if (faces_ != nullptr) {
      borrowed = centres;
      borrowed->face = faces_->OfCentres(centres);
    }
    film_ = Shade(borrowed ? *borrowed : centres, frame, subject_.colors,
                  HowToShade(subject_, {}, options_, light_ ? &light_->value() : nullptr));
    if (film_->ok()) RunWithThreads(options_.execution.threads, [&] { AddContrast(film_->value(), set); });
    if (also_ != nullptr) set->Add(*also_);
    shade_ms_ = stopwatch.Milliseconds();
  }

  // The shaded centres; nothing before Pick, or if their light could not be cast.
  std::optional<Result<Film>>& film() { return film_; }
  // The light of the centres; nothing before Pick, and without a lighter.
  std::optional<Result<SampleLight>>& light() { return light_; }
  double shade_ms() const { return shade_ms_; }

 private:
  const Subject& subject_;
  const ViewOptions& options_;
  const BorrowedFaces* faces_;
  const PixelSet* also_;
  ViewLighter* lighter_;
  std::optional<Result<Film>> film_;
  std::optional<Result<SampleLight>> light_;
  double shade_ms_ = 0;
};

// Makes the view of one representation.
class ViewMaker {
 public:
  ViewMaker(const Representation& representation, const Camera& camera, const Subject& subject,
            const ViewOptions& options)
      : representation_(representation),
        camera_(camera),
        subject_(subject),
        options_(options),
        grid_(EvenSampleGrid(options.samples)) {}

  // Makes the view. `reference` is null for a view without a comparison, for which lines are found here.
  Result<View> Make(const ReferenceView* reference) {
    const Stopwatch stopwatch;
    if (!representation_.names_faces()) {
      if (reference != nullptr) {
        faces_.emplace(reference->view.samples, reference->all_samples, reference->refinement);
      } else {
        faces_.emplace(subject_.colors);
      }
    }
    if (options_.light.any()) {
      lighter_.emplace(representation_, subject_.model, options_.light, options_.up, options_.sections,
                       options_.execution);
      if (auto made = lighter_->Prepare(subject_.transparent, subject_.colors); !made.ok())
        return made.error();
    }
    if (IsAdaptive())
      picker_.emplace(
          subject_, options_, faces_ ? &*faces_ : nullptr,
          reference != nullptr && reference->refinement != nullptr ? &reference->refinement->pixels : nullptr,
          lighter_ ? &*lighter_ : nullptr);
    if (auto done = TraceCentres(); !done.ok()) return done.error();
    if (auto done = TraceColors(); !done.ok()) return done.error();
    if (auto done = TraceBehind(); !done.ok()) return done.error();
    if (lighter_)
      if (auto done = CastLightOfSamples(); !done.ok()) return done.error();
    if (reference == nullptr)
      if (auto done = FindOwnLines(); !done.ok()) return done.error();
    if (auto done = MakePicture(reference); !done.ok()) return done.error();
    if (lighter_) view_.light = lighter_->Finish(std::move(light_.centres));
    view_.total_ms = stopwatch.Milliseconds();
    return std::move(view_);
  }
  // What a candidate needs of this view, `view`, after Make.
  ReferenceView Lend(const View& view) const {
    return {view, color_samples_.size() > 0 ? &color_samples_ : nullptr,
            refinement_ ? &*refinement_ : nullptr};
  }

 private:
  // Everything but a plain picture needs the samples of all pixels.
  bool IsAdaptive() const {
    return options_.samples > 1 && !options_.uniform_samples && !options_.edges && !options_.find_lines &&
           options_.lines == LineMode::kNone && options_.inspection.kind == InspectionKind::kStudio &&
           options_.sections.empty() && subject_.transparent.empty();
  }

  Result<void> TraceCentres() {
    const RefineRequest refine{grid_, picker_ ? &*picker_ : nullptr, options_.light.any()};
    Result<TracedView> traced =
        representation_.Trace(camera_,
                              {.uv = options_.uv || options_.light.any() || NeedsUv(options_.inspection.kind),
                               .depth_error = options_.depth_error || options_.light.any(),
                               .audit = options_.audit,
                               .refine = picker_ ? &refine : nullptr},
                              options_.execution);
    if (!traced.ok()) return traced.error();
    TracedView& centres = traced.value();
    refinement_ = std::move(centres.refinement);
    view_.frame = color_frame_ = centres.frame;
    view_.samples = std::move(centres.samples);
    view_.counters = centres.counters;
    view_.direct = std::move(centres.direct);
    view_.solver = std::move(centres.solver);
    if (view_.direct)
      for (const std::uint32_t face : view_.direct->unseen_faces)
        view_.unseen_names.push_back(subject_.model.PlacedFaceName(face));
    view_.grid = grid_;
    view_.peak_bytes = centres.structure_bytes + BufferBytes(view_.samples) + FilmBytes(view_.samples);
    if (refinement_) {
      view_.refined_pixels = refinement_->pixels.size();
      view_.color_ms = std::max(0.0, centres.counters.refine_ms - picker_->shade_ms());
      view_.peak_bytes += BufferBytes(refinement_->samples);
    }
    return {};
  }

  // The report's certificates are those of the pixel centres, so that the colour pass needs none.
  TraceRequest ColorRequest() const {
    return {.uv = options_.light.any() || NeedsExactSurface(options_.inspection.kind),
            .depth_error = options_.light.any(),
            .certificates = false};
  }

  Result<void> TraceColors() {
    if (options_.samples == 1 || refinement_) return {};
    const Stopwatch stopwatch;
    Result<TracedView> color =
        representation_.Trace(camera_.Supersampled(grid_.x, grid_.y), ColorRequest(), options_.execution);
    if (!color.ok()) return color.error();
    color_frame_ = color.value().frame;
    color_samples_ = std::move(color.value().samples);
    view_.color_ms = stopwatch.Milliseconds();
    view_.peak_bytes =
        std::max(view_.peak_bytes, color.value().structure_bytes + BufferBytes(view_.samples) +
                                       BufferBytes(color_samples_) + FilmBytes(color_samples_));
    return {};
  }

  // Traces what lies behind transparent faces. If a representation names no faces, its transparent faces are
  // not known.
  Result<void> TraceBehind() {
    if (subject_.transparent.empty() || !representation_.names_faces()) return {};
    const Stopwatch stopwatch;
    Result<TracedView> seen = representation_.Trace(camera_.Supersampled(grid_.x, grid_.y),
                                                    {.uv = options_.light.any(),
                                                     .depth_error = options_.light.any(),
                                                     .certificates = false,
                                                     .leave_out = &subject_.transparent},
                                                    options_.execution);
    if (!seen.ok()) return seen.error();
    behind_ = std::move(seen.value().samples);
    view_.color_ms += stopwatch.Milliseconds();
    return {};
  }

  // Casts the light of the pixel centres and of the samples of the colour.
  Result<void> CastLightOfSamples() {
    const auto cast = [](Result<SampleLight> from, SampleLight* to) -> Result<void> {
      if (!from.ok()) return from.error();
      *to = std::move(from).value();
      return {};
    };
    if (picker_ && picker_->light()) {
      if (auto done = cast(*std::move(picker_->light()), &light_.centres); !done.ok()) return done;
    } else if (auto done = cast(lighter_->Cast(view_.samples, view_.frame), &light_.centres); !done.ok()) {
      return done;
    }
    if (refinement_)
      if (auto done = cast(lighter_->Cast(*refinement_), &light_.color); !done.ok()) return done;
    if (color_samples_.size() > 0)
      if (auto done = cast(lighter_->Cast(color_samples_, color_frame_), &light_.color); !done.ok())
        return done;
    if (behind_.size() > 0)
      if (auto done = cast(lighter_->Cast(behind_, color_frame_), &light_.behind); !done.ok()) return done;
    return {};
  }

  Result<void> FindOwnLines() {
    const Scene* scene = representation_.exact();
    if (scene == nullptr || (options_.lines == LineMode::kNone && !options_.find_lines)) return {};
    const Stopwatch stopwatch;
    view_.lines = FindLines(*scene, camera_, view_.frame, Color(), color_frame_,
                            {.sections = options_.sections, .execution = options_.execution});
    if (options_.execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled while finding lines"};
    std::erase_if(view_.lines, [&](const ViewLine& line) {
      return !line.visible && (options_.lines != LineMode::kHidden || line.kind == LineClass::kSeam ||
                               line.kind == LineClass::kSmooth);
    });
    view_.lines_ms = stopwatch.Milliseconds();
    return {};
  }

  Result<void> MakePicture(const ReferenceView* reference) {
    const Stopwatch stopwatch;
    auto inspected = Inspected(subject_.model, representation_.exact(), view_.samples, view_.frame, options_);
    if (!inspected.ok()) return inspected.error();
    view_.inspection = std::move(inspected).value();
    Result<Image8> image = refinement_ ? DevelopRefined() : DevelopAll(reference);
    if (!image.ok()) return image.error();
    view_.image = std::move(image).value();
    view_.shade_ms = stopwatch.Milliseconds() + (refinement_ ? picker_->shade_ms() : 0);
    return {};
  }

  // The picture of an adaptive view: its centres, and the means of the samples of its refined pixels.
  Result<Image8> DevelopRefined() {
    if (faces_) refinement_->samples.face = faces_->OfRefinement(*refinement_);
    Result<Film> film = *std::move(picker_->film());
    if (!film.ok()) return film.error();
    if (auto done = ShadeRefinement(*refinement_, subject_.colors,
                                    HowToShade(subject_, grid_, options_, lighter_ ? &light_.color : nullptr),
                                    &film.value());
        !done.ok())
      return done.error();
    std::optional<Result<Image8>> image;
    RunWithThreads(options_.execution.threads, [&] { image = Encode(film.value()); });
    return *std::move(image);
  }

  Result<Image8> DevelopAll(const ReferenceView* reference) {
    std::optional<SampleBuffer> borrowed;
    if (faces_) {
      borrowed = Color();
      borrowed->face =
          color_samples_.size() > 0 ? faces_->OfAllSamples(*borrowed, grid_) : faces_->OfCentres(*borrowed);
    }
    const SampleBuffer& color = borrowed ? *borrowed : Color();
    const std::vector<ViewLine>& lines = reference != nullptr ? reference->view.lines : view_.lines;
    return Develop(
        {color, color_frame_, grid_, representation_.exact(), lines, behind_.size() > 0 ? &behind_ : nullptr,
         lighter_ ? ColorLight() : nullptr, lighter_ ? &light_.behind : nullptr},
        subject_, Address(view_.inspection), options_);
  }

  const SampleBuffer& Color() const { return color_samples_.size() > 0 ? color_samples_ : view_.samples; }
  const SampleLight* ColorLight() const {
    return color_samples_.size() > 0 ? &light_.color : &light_.centres;
  }

  const Representation& representation_;
  const Camera& camera_;
  const Subject& subject_;
  const ViewOptions& options_;
  const SampleGrid grid_;
  View view_;
  std::optional<BorrowedFaces> faces_;    // if the representation names none
  std::optional<ContrastPicker> picker_;  // if the view is adaptive
  std::optional<Refinement> refinement_;  // if it is, and the representation can refine
  SampleBuffer color_samples_;            // empty where the pixel-centre pass is the colour pass
  CameraFrame color_frame_;               // of the colour pass
  SampleBuffer behind_;                   // empty where nothing is transparent
  std::optional<ViewLighter> lighter_;    // nothing if no secondary rays are needed
  struct {
    SampleLight centres, color, behind;  // of the pixel centres, of the colour's samples, and of behind_
  } light_;
};

// Checks whether the view of a representation can be made.
Result<void> CheckCanShow(const Representation& representation, const ViewOptions& options) {
  if (representation.exact() != nullptr) return {};
  return CheckMeshCanShow(options.inspection, representation.names_faces());
}

void NameCaps(const SectionSolids& solids, Difference* difference) {
  for (FaceDifference& face : difference->faces) {
    if (face.id < solids.first_cap()) continue;
    const std::uint32_t cap = face.id - solids.first_cap();
    face.name =
        "section " + std::to_string(cap / solids.stride()) + " of " + solids.Name(cap % solids.stride());
  }
}

// Makes the view of a candidate, and compares it with the reference.
Result<CandidateView> CompareCandidate(const ReferenceView& reference, const Representation& representation,
                                       const Subject& subject, const Camera& camera,
                                       const ViewOptions& options) {
  Result<View> made = ViewMaker(representation, camera, subject, options).Make(&reference);
  if (!made.ok()) return made.error();
  CandidateView candidate;
  candidate.name = representation.name();
  candidate.title = representation.title();
  candidate.make_ms = representation.make_ms();
  candidate.facts = representation.facts();
  candidate.view = std::move(made).value();

  const Stopwatch stopwatch;
  const View &exact = reference.view, &view = candidate.view;
  std::optional<Result<Difference>> difference;
  std::optional<Result<DifferencePicture>> picture;
  RunWithThreads(options.execution.threads, [&] {
    difference =
        ComputeDifference({exact.samples, view.samples, exact.image, view.image, exact.frame, subject.model,
                           representation.names_faces(), representation.noise_mm(), options.color});
    if (difference->ok())
      picture =
          DrawDifference(exact.samples, view.samples, exact.frame, difference->value(), options.picture);
  });
  if (!difference->ok()) return difference->error();
  if (!picture->ok()) return picture->error();
  candidate.difference = std::move(*difference).value();
  candidate.picture = std::move(*picture).value();
  if (exact.light && options.light.casts()) {
    std::optional<Result<LightComparison>> light;
    RunWithThreads(options.execution.threads, [&] {
      light = CompareLight({exact.samples, *exact.light}, {view.samples, *view.light}, exact.frame,
                           representation.names_faces(), exact.image);
    });
    if (!light->ok()) return light->error();
    candidate.light = std::move(*light).value();
  }
  if (subject.solids) NameCaps(*subject.solids, &candidate.difference);
  candidate.difference_ms = stopwatch.Milliseconds();
  return candidate;
}

Error OutOfMemory(const Camera& camera) {
  return {ErrorCode::kLimitExceeded, "view '" + camera.name + "': its pictures do not fit into memory"};
}

}  // namespace

Result<View> RenderView(const Representation& representation, const Model& model, const Camera& camera,
                        const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  if (Result<void> can = CheckCanShow(representation, options); !can.ok()) return can.error();
  try {
    const Subject subject(model, options);
    return ViewMaker(representation, camera, subject, options).Make(nullptr);
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

Result<ViewComparison> CompareView(const Representation& reference,
                                   std::span<const Representation* const> candidates, const Model& model,
                                   const Camera& camera, const ViewOptions& options) {
  if (Result<void> sound = CheckOptions(options); !sound.ok()) return sound.error();
  for (const Representation* candidate : candidates)
    if (Result<void> can = CheckCanShow(*candidate, options); !can.ok()) return can.error();
  try {
    ViewComparison comparison;
    comparison.camera = camera;
    const Subject subject(model, options);
    ViewMaker reference_maker(reference, camera, subject, options);
    Result<View> made = reference_maker.Make(nullptr);
    if (!made.ok()) return made.error();
    comparison.reference = std::move(made).value();
    const ReferenceView lent = reference_maker.Lend(comparison.reference);
    for (const Representation* candidate : candidates) {
      Result<CandidateView> compared = CompareCandidate(lent, *candidate, subject, camera, options);
      if (!compared.ok()) return compared.error();
      comparison.candidates.push_back(std::move(compared).value());
    }
    return comparison;
  } catch (const std::bad_alloc&) {
    return OutOfMemory(camera);
  }
}

}  // namespace facetless
