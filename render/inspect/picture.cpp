#include "render/inspect/picture.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/image/color_map.h"
#include "render/inspect/angle.h"
#include "render/inspect/stripes.h"

namespace facetless {
namespace {

// The share of light on a surface that is seen edge-on.
constexpr double kDarkest = 0.75;

constexpr std::size_t kNoPixel = std::numeric_limits<std::size_t>::max();

using Rgb = std::array<std::uint8_t, 3>;

Color ToColor(Rgb rgb) {
  return {rgb[0] / 255.0f, rgb[1] / 255.0f, rgb[2] / 255.0f};
}
Vec3 Linear(const Color& color) {
  return {SrgbToLinear(color.r), SrgbToLinear(color.g), SrgbToLinear(color.b)};
}

constexpr Rgb kNoNumber = {150, 150, 150};
constexpr Rgb kPlain = {205, 208, 212}, kSignal = {204, 30, 140}, kWarning = {230, 159, 0};

// The classes of each kind, in the order of Painter::ClassOf. The colours are distinct for all common kinds
// of colour blindness (Okabe and Ito).
std::vector<InspectionClass> InspectionClasses(const Inspection& inspection) {
  const auto classes = [](std::initializer_list<std::pair<const char*, Rgb>> list) {
    std::vector<InspectionClass> out;
    for (const auto& [name, rgb] : list) out.push_back({name, ToColor(rgb), 0});
    return out;
  };
  switch (inspection.kind) {
    case InspectionKind::kZebra:
    case InspectionKind::kIsophotes:
      return classes({{"light", {244, 244, 242}}, {"dark", {22, 22, 26}}});
    case InspectionKind::kReflection:
      return classes({{"line", {250, 248, 240}}, {"ground", {58, 66, 78}}, {"no line", {44, 47, 54}}});
    case InspectionKind::kDraft:
      return classes({{"enough", {0, 158, 115}}, {"too little", {240, 228, 66}}, {"undercut", {213, 94, 0}}});
    case InspectionKind::kBack:
      return classes({{"front", kPlain}, {"back", kSignal}});
    case InspectionKind::kUnseen:
      return classes({{"seen", kPlain}, {"hardly seen", kWarning}, {"back", kSignal}});
    default:
      return {};
  }
}

// A colour scale as a table, with equal steps from the lowest to the highest number.
class ColorScale {
 public:
  explicit ColorScale(bool has_sign) {
    for (int i = 0; i <= kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps;
      colors_.push_back(Linear(ToColor(has_sign ? DivergingColor(2 * t - 1) : SequentialColor(t))));
    }
  }
  // The colour at t. NaN, which infinity minus infinity gives, has the lowest colour.
  Vec3 At(double t) const {
    return colors_[static_cast<std::size_t>((t > 0 ? std::min(t, 1.0) : 0) * kSteps + 0.5)];
  }

 private:
  static constexpr int kSteps = 1024;
  std::vector<Vec3> colors_;
};

// The side from which the viewer sees the surface: 1 from outside, −1 from inside.
double SideOf(Vec3 normal, Vec3 toward) {
  return Dot(normal, toward) < -kSettled ? -1 : 1;
}

class Painter {
 public:
  Painter(const InspectionView& view, const SampleBuffer& samples, const PerSample<double>& values,
          const CameraFrame& frame, const Box3& bounds)
      : view_(view),
        samples_(samples),
        values_(values),
        direction_(Resolved(view.inspection.direction, frame)),
        enough_(SineOfDeg(view.inspection.limit_deg)),
        pattern_(view.inspection, frame, bounds),
        scale_(view.quantity.has_sign),
        none_(Linear(ToColor(kNoNumber))) {
    for (const InspectionClass& one : InspectionClasses(view.inspection))
      class_colors_.push_back(Linear(one.color));
  }

  // Requires a kind with classes. `normal` is the outward one.
  std::size_t ClassOf(std::size_t i, Vec3 position, Vec3 normal, Vec3 toward) const {
    const double side = SideOf(normal, toward);
    switch (view_.inspection.kind) {
      case InspectionKind::kDraft: {
        const bool turned = side < 0 && view_.inspection.orient == Orient::kViewer;
        const double sine = Dot(turned ? -normal : normal, direction_);
        return sine > enough_ - kSettled ? 0 : sine < kSettled - enough_ ? 2 : 1;
      }
      case InspectionKind::kBack:
        return side < 0 ? 1 : 0;
      case InspectionKind::kUnseen: {
        if (side < 0) return 2;
        const std::uint32_t face = samples_.face[i];
        const bool few = face < view_.face_pixels.size() &&
                         view_.face_pixels[face] < static_cast<std::uint32_t>(view_.inspection.few_pixels);
        return few ? 1 : 0;
      }
      default: {
        const Vec3 turned = Dot(normal, toward) < 0 ? -normal : normal;
        return static_cast<std::size_t>(pattern_.At(position, turned, toward));
      }
    }
  }

  Vec3 ColorOf(std::size_t i, Vec3 position, Vec3 normal, Vec3 toward) const {
    if (!class_colors_.empty()) return class_colors_[ClassOf(i, position, normal, toward)];
    if (view_.inspection.kind == InspectionKind::kFaces)
      return Linear(ToColor(CategoryColor(samples_.face[i])));
    const double value = values_[i];
    if (!std::isfinite(value)) return none_;
    return scale_.At((value - view_.range.low) / (view_.range.high - view_.range.low));
  }

 private:
  const InspectionView& view_;
  const SampleBuffer& samples_;
  const PerSample<double>& values_;
  const Vec3 direction_;
  const double enough_;
  const StripePattern pattern_;
  const ColorScale scale_;
  const Vec3 none_;
  std::vector<Vec3> class_colors_;
};

// The position of a sample, its normal and the direction to the viewer. If the tracer could not find a
// normal, the direction to the viewer is used.
struct Seen {
  Vec3 position, normal, toward;
};

Seen SeenAt(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i) {
  const auto width = static_cast<std::size_t>(samples.width);
  const Ray ray = PixelRay(frame, static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
  const auto& n = samples.normal[i];
  Seen seen{ray.origin + samples.depth[i] * ray.direction, Normalized({n[0], n[1], n[2]}),
            Normalized(-ray.direction)};
  if (!(Length(seen.normal) > 0)) seen.normal = seen.toward;
  return seen;
}

bool IsNumber(const SampleBuffer& samples, std::size_t i) {
  const auto& n = samples.normal[i];
  return std::isfinite(samples.depth[i]) && std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
}

// Returns whether the id is that of a section cap. Caps have ids above those of the faces.
bool IsCap(const Model& model, std::uint32_t face) {
  return face != kNoIndex && face >= model.PlacedFaceCount();
}

Result<void> CheckSizes(const SampleBuffer& samples) {
  const std::size_t count =
      static_cast<std::size_t>(samples.width) * static_cast<std::size_t>(samples.height);
  if (samples.width < 1 || samples.height < 1 || samples.depth.size() != count ||
      samples.normal.size() != count || samples.face.size() != count)
    return Error{ErrorCode::kSizeMismatch, "depth, normal and face of the samples have different sizes"};
  return {};
}

}  // namespace

Result<InspectionView> Measure(const Model& model, const Scene* scene, const SampleBuffer& centres,
                               const CameraFrame& frame, const Inspection& inspection,
                               const Execution& execution) {
  if (Result<void> sound = CheckSizes(centres); !sound.ok()) return sound.error();
  InspectionView view;
  view.inspection = inspection;
  view.quantity = InspectionQuantity(inspection);

  // Compute the numbers.
  if (HasValues(inspection.kind)) {
    Result<PerSample<double>> values = InspectionValues(model, scene, centres, frame, inspection, execution);
    if (!values.ok()) return values.error();
    view.values = std::move(values).value();
    view.statistics = ComputeStatistics(view.values, centres);
    view.range = ResolveRange(inspection, view.statistics, model.Diagonal());
  }

  // Count the pixels of the faces, and then of the classes, which may depend on them.
  if (inspection.kind == InspectionKind::kUnseen) {
    view.face_pixels.assign(model.PlacedFaceCount(), 0);
    for (std::uint32_t face : centres.face)
      if (face < view.face_pixels.size()) ++view.face_pixels[face];
  }
  for (std::size_t i = 0; i < centres.size(); ++i)
    view.back_pixels += IsNumber(centres, i) && !IsCap(model, centres.face[i]) && IsBack(centres, frame, i);
  view.classes = InspectionClasses(inspection);
  if (view.classes.empty()) return view;
  const Painter painter(view, centres, view.values, frame, model.bounds);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (!IsNumber(centres, i) || IsCap(model, centres.face[i])) continue;
    const Seen seen = SeenAt(centres, frame, i);
    ++view.classes[painter.ClassOf(i, seen.position, seen.normal, seen.toward)].pixels;
  }
  return view;
}

Result<Film> Draw(const Model& model, const Scene* scene, const SampleBuffer& samples,
                  const CameraFrame& frame, const InspectionView& view, const ShadeOptions& options) {
  if (Result<void> sound = CheckSizes(samples); !sound.ok()) return sound.error();
  // Only pictures with a scale need a number for every sample; the picture of draft has classes.
  const bool scaled = NeedsExactSurface(view.inspection.kind), same = view.values.size() == samples.size();
  PerSample<double> own;
  if (scaled && !same) {
    Result<PerSample<double>> values =
        InspectionValues(model, scene, samples, frame, view.inspection, options.execution);
    if (!values.ok()) return values.error();
    own = std::move(values).value();
  }
  const Painter painter(view, samples, same ? view.values : own, frame, model.bounds);
  const std::array<float, 4> background = BackgroundLight(options.background);

  Film film;
  film.width = samples.width;
  film.height = samples.height;
  film.pixels.resize(samples.size());
  std::atomic<std::size_t> bad{kNoPixel};
  RunWithThreads(options.execution.threads, [&] {
    ParallelFor(0, samples.height, [&](int y) {
      const std::size_t first = static_cast<std::size_t>(y) * samples.width;
      for (std::size_t i = first; i < first + samples.width; ++i) {
        if (samples.depth[i] == INFINITY) {
          film.pixels[i] = background;
          continue;
        }
        if (!IsNumber(samples, i)) {
          std::size_t known = bad.load();
          while (i < known && !bad.compare_exchange_weak(known, i)) {
          }
          return;
        }
        const Seen seen = SeenAt(samples, frame, i);
        const double matte = kDarkest + (1 - kDarkest) * std::fabs(Dot(seen.normal, seen.toward));
        const bool cap = IsCap(model, samples.face[i]);
        const Vec3 light = matte * (cap ? Linear(ToColor(kNoNumber))
                                        : painter.ColorOf(i, seen.position, seen.normal, seen.toward));
        film.pixels[i] = {static_cast<float>(light.x), static_cast<float>(light.y),
                          static_cast<float>(light.z), 1.0f};
        if (cap)
          HatchCap(options, samples.face[i], static_cast<double>(i - first) + 0.5, y + 0.5, &film.pixels[i]);
      }
    });
  });
  if (bad.load() != kNoPixel)
    return Error{ErrorCode::kNotFinite, "the hit at pixel (" + std::to_string(bad.load() % samples.width) +
                                            ", " + std::to_string(bad.load() / samples.width) +
                                            ") has a depth or a normal that is not a number"};
  if (options.edges) DrawFeatureEdges(samples, frame, options, film);
  return film;
}

}  // namespace facetless
