#include "render/inspect/values.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "render/base/parallel.h"
#include "render/inspect/angle.h"
#include "render/inspect/curvature.h"
#include "render/inspect/thickness.h"
#include "render/model/walk.h"

namespace facetless {
namespace {

constexpr double kNone = INFINITY;
constexpr double kLowShare = 0.02, kHighShare = 0.98;
// A curvature below this share of 1/diagonal counts as flat. It bends the whole model by less than 1/8000 of
// its size.
constexpr double kFlat = 1e-3;

double Chosen(const Curvature& curvature, CurvatureKind kind) {
  switch (kind) {
    case CurvatureKind::kGaussian:
      return curvature.gaussian();
    case CurvatureKind::kMax:
      return curvature.max;
    case CurvatureKind::kMin:
      return curvature.min;
    default:
      return curvature.mean();
  }
}

// Evaluates the samples of a view.
class Evaluator {
 public:
  Evaluator(const Model& model, const Scene* scene, const SampleBuffer& samples, const CameraFrame& frame,
            const Inspection& inspection)
      : model_(model),
        samples_(samples),
        inspection_(inspection),
        frame_(frame),
        pull_(Resolved(inspection.direction, frame)) {
    for (std::uint32_t i = 0; i < model_.instances.size(); ++i) {
      for (const std::uint32_t face : Indices(FacesOf(model_, model_.instances[i])))
        placed_.push_back({face, i, OutwardSign(model_.faces[face], model_.instances[i].placement)});
    }
    if (samples.uv.empty()) return;
    surfaces_.reserve(model_.faces.size());
    for (const Face& face : model_.faces) surfaces_.emplace_back(model_, face.surface);
    if (inspection.kind != InspectionKind::kThickness) return;
    std::vector<bool> shown(model_.faces.size(), false);
    for (std::uint32_t id : samples.face)
      if (id < placed_.size()) shown[placed_[id].face] = true;
    thickness_.emplace(*scene, surfaces_, shown);
  }

  double At(std::size_t i) const {
    if (!std::isfinite(samples_.depth[i])) return kNone;
    const auto& n = samples_.normal[i];
    const Vec3 rough = Normalized({n[0], n[1], n[2]});
    if (samples_.face[i] >= placed_.size() && samples_.face[i] != kNoIndex)
      return kNone;  // the cap of a section
    const double turn = inspection_.orient == Orient::kViewer && IsBack(samples_, frame_, i) ? -1 : 1;
    if (samples_.uv.empty() || samples_.face[i] >= placed_.size()) return DraftOf(turn * rough);
    PlacedFace placed = placed_[samples_.face[i]];
    placed.outward *= turn;
    const SurfaceEval& surface = surfaces_[placed.face];
    const Placement& placement = model_.instances[placed.instance].placement;
    const double u = samples_.uv[i][0], v = samples_.uv[i][1];
    const double extent_u = surface.u_end() - surface.u_begin(),
                 extent_v = surface.v_end() - surface.v_begin();
    if (inspection_.kind == InspectionKind::kCurvature) {
      const std::optional<Curvature> curvature =
          CurvatureAt(Placed(surface.Second(u, v), placement), placed.outward, extent_u, extent_v);
      return curvature ? Chosen(*curvature, inspection_.curvature) : kNone;
    }
    // At a pole, use the one-sided normal of the tracer.
    const std::optional<TangentFrame> frame =
        FrameAt(Placed(surface.First(u, v), placement), placed.outward, extent_u, extent_v);
    const Vec3 normal = frame ? frame->normal : turn * rough;
    if (inspection_.kind == InspectionKind::kDraft) return DraftOf(normal);
    return thickness_->At(placed.face, placement, u, v, normal).value_or(kNone);
  }

 private:
  struct PlacedFace {
    std::uint32_t face, instance;
    double outward;
  };

  double DraftOf(Vec3 normal) const { return Length(normal) > 0 ? DraftDeg(normal, pull_) : kNone; }

  const Model& model_;
  const SampleBuffer& samples_;
  const Inspection& inspection_;
  const CameraFrame& frame_;
  const Vec3 pull_;
  std::vector<PlacedFace> placed_;
  std::vector<SurfaceEval> surfaces_;  // by Model::faces
  std::optional<Thickness> thickness_;
};

}  // namespace

bool IsBack(const SampleBuffer& samples, const CameraFrame& frame, std::size_t i) {
  const auto width = static_cast<std::size_t>(samples.width);
  const Ray ray = PixelRay(frame, static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
  const auto& n = samples.normal[i];
  return Dot(Normalized({n[0], n[1], n[2]}), Normalized(ray.direction)) > kSettled;
}

bool HasValues(InspectionKind kind) {
  return kind == InspectionKind::kCurvature || kind == InspectionKind::kDraft ||
         kind == InspectionKind::kThickness;
}

Quantity InspectionQuantity(const Inspection& inspection) {
  switch (inspection.kind) {
    case InspectionKind::kCurvature:
      switch (inspection.curvature) {
        case CurvatureKind::kGaussian:
          return {"gaussian curvature", "1/mm2", true};
        case CurvatureKind::kMax:
          return {"largest curvature", "1/mm", true};
        case CurvatureKind::kMin:
          return {"smallest curvature", "1/mm", true};
        default:
          return {"mean curvature", "1/mm", true};
      }
    case InspectionKind::kDraft:
      return {"draft", "deg", true};
    case InspectionKind::kThickness:
      return {"thickness", "mm", false};
    default:
      return {};
  }
}

bool NeedsUv(InspectionKind kind) {
  return HasValues(kind);
}

Result<PerSample<double>> InspectionValues(const Model& model, const Scene* scene,
                                           const SampleBuffer& samples, const CameraFrame& frame,
                                           const Inspection& inspection, const Execution& execution) {
  if (NeedsExactSurface(inspection.kind) && (samples.uv.empty() || scene == nullptr))
    return Error{ErrorCode::kBadUsage, "shade: the samples hold no surface parameters to measure at"};
  if (samples.normal.size() != samples.size() || samples.face.size() != samples.size() ||
      (!samples.uv.empty() && samples.uv.size() != samples.size()))
    return Error{ErrorCode::kSizeMismatch, "depth, normal, face and uv of the samples have different sizes"};
  PerSample<double> values(samples.size());
  RunWithThreads(execution.threads, [&] {
    const Evaluator evaluator(model, scene, samples, frame, inspection);
    const auto width = static_cast<std::size_t>(samples.width);
    ParallelFor(0, samples.height, [&](int y) {
      if (execution.cancelled()) return;
      for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
        const double value = evaluator.At(i);
        values[i] = std::isfinite(value) ? value : kNone;
      }
    });
  });
  if (execution.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  return values;
}

ValueStatistics ComputeStatistics(const PerSample<double>& values, const SampleBuffer& samples) {
  ValueStatistics statistics;
  std::vector<double> numbers;
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) {
      numbers.push_back(values[i]);
      sum += values[i];
    } else if (std::isfinite(samples.depth[i])) {
      ++statistics.none;
    }
  }
  statistics.count = numbers.size();
  if (numbers.empty()) return statistics;
  std::sort(numbers.begin(), numbers.end());
  const auto at = [&](double share) {
    return numbers[static_cast<std::size_t>(share * static_cast<double>(numbers.size() - 1))];
  };
  statistics.min = numbers.front();
  statistics.max = numbers.back();
  statistics.mean = sum / static_cast<double>(numbers.size());
  statistics.p2 = at(kLowShare);
  statistics.p50 = at(0.5);
  statistics.p98 = at(kHighShare);
  return statistics;
}

ValueRange ResolveRange(const Inspection& inspection, const ValueStatistics& statistics, double diagonal_mm) {
  if (inspection.range) return *inspection.range;
  if (inspection.kind == InspectionKind::kDraft) return {-90, 90};
  const double diagonal = diagonal_mm > 0 ? diagonal_mm : 1;
  if (inspection.kind == InspectionKind::kCurvature) {
    const double flat = kFlat / diagonal;
    const double least = inspection.curvature == CurvatureKind::kGaussian ? flat * flat : flat;
    const double most = std::max({std::fabs(statistics.p2), std::fabs(statistics.p98), least});
    return {-most, most};
  }
  if (statistics.count == 0) return {0, 1};
  // The scale of thickness starts at 0.
  return {0, statistics.p98 > 0 ? statistics.p98 : 1};
}

}  // namespace facetless
