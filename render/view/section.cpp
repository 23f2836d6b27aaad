#include "render/view/section.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "render/model/walk.h"

namespace facetless {
namespace {

// The rounding of a plane's depth: two differences, two dot products of three terms, and one quotient.
constexpr double kPlaneRounding = 8 * std::numeric_limits<double>::epsilon();
// The largest difference between 1 and the square of a unit vector, due to rounding.
constexpr double kUnitRounding = 1e-9;

}  // namespace

Result<void> CheckSections(std::span<const SectionPlane> planes) {
  if (planes.size() > kMostSectionPlanes)
    return Error{ErrorCode::kBadUsage, "there are " + std::to_string(planes.size()) + " section planes; " +
                                           std::to_string(kMostSectionPlanes) + " are allowed"};
  for (const SectionPlane& plane : planes) {
    if (!std::isfinite(Dot(plane.point, plane.point)))
      return Error{ErrorCode::kBadUsage,
                   "the point of a section plane must lie within 1e150 mm of the origin"};
    if (!(std::fabs(Dot(plane.normal, plane.normal) - 1) <= kUnitRounding))
      return Error{ErrorCode::kBadUsage, "the normal of a section plane must be a unit vector"};
  }
  return {};
}

SectionSolids::SectionSolids(const Model& model) : model_(&model) {
  solid_of_face_.assign(model.PlacedFaceCount(), kNoIndex);
  for (std::uint32_t i = 0; i < model.instances.size(); ++i) {
    const Instance& instance = model.instances[i];
    const Part& part = model.parts[instance.part];
    const std::uint32_t first = count();
    for (const std::uint32_t s : Indices(part.solids)) solids_.push_back({i, s});
    for (const PlacedFace placed : WalkPlacedFaces(model, instance)) {
      const std::uint32_t solid = model.faces[placed.face].solid;
      if (solid != kNoIndex && model.solids[solid].closed)
        solid_of_face_[placed.id] = first + solid - part.solids.first;
    }
  }
}

std::string SectionSolids::Name(std::uint32_t solid) const {
  if (solid >= solids_.size()) return "solid";
  const Instance& instance = model_->instances[solids_[solid].instance];
  const Part& part = model_->parts[instance.part];
  const Solid& own = model_->solids[solids_[solid].solid];
  std::string name = instance.name.empty() ? part.name : instance.name;
  if (part.solids.count > 1 || name.empty()) {
    if (!name.empty()) name += "/";
    name += own.name.empty() ? "solid " + std::to_string(solids_[solid].solid - part.solids.first) : own.name;
  }
  return name;
}

Color SectionSolids::ColorOf(std::uint32_t solid) const {
  if (solid >= solids_.size()) return {};
  const Instance& instance = model_->instances[solids_[solid].instance];
  std::map<std::tuple<float, float, float>, std::size_t> uses;
  Color commonest;
  std::size_t most = 0;
  for (const PlacedFace placed : WalkPlacedFaces(*model_, instance)) {
    if (model_->faces[placed.face].solid != solids_[solid].solid) continue;
    const Color color = model_->PlacedFaceColor(placed.id);
    const std::size_t count = ++uses[{color.r, color.g, color.b}];
    if (count > most) {
      most = count;
      commonest = color;
    }
  }
  return commonest;
}

KeptInterval ClipRayToSections(const Ray& ray, std::span<const SectionPlane> planes, double near_depth) {
  KeptInterval kept;
  kept.begin = near_depth;
  for (int i = 0; i < static_cast<int>(planes.size()); ++i) {
    const SectionPlane& plane = planes[i];
    const double height = Dot(plane.normal, ray.origin - plane.point);
    const double rate = Dot(plane.normal, ray.direction);
    if (rate == 0) {
      // A ray in the plane itself belongs to the removed side (law 4).
      if (height >= 0) return {INFINITY, -INFINITY, 0, 0, -1};
      continue;
    }
    const double depth = -height / rate;
    const double error =
        kPlaneRounding *
        (std::fabs(depth) + (Length(ray.origin) + Length(plane.point) + std::fabs(depth)) / std::fabs(rate));
    if (rate < 0 && depth > kept.begin) {
      kept.begin = depth;
      kept.begin_error = error;
      kept.plane = i;
    } else if (rate > 0 && depth < kept.end) {
      kept.end = depth;
      kept.end_error = error;
    }
  }
  return kept;
}

SectionAnswer SectionDecision::Decide(std::span<const SolidCrossing> crossings, const KeptInterval& kept) {
  SectionAnswer answer;
  if (!(kept.begin < kept.end)) return answer;

  // For each solid, count all crossings and those beyond the beginning of the interval.
  counts_.clear();
  std::uint32_t first = kNoIndex;
  for (std::uint32_t i = 0; i < crossings.size(); ++i) {
    const SolidCrossing& crossing = crossings[i];
    const double from_begin = crossing.depth - kept.begin, from_end = kept.end - crossing.depth;
    const double begin_error = crossing.error + kept.begin_error, end_error = crossing.error + kept.end_error;
    const bool beyond = from_begin > begin_error;
    answer.uncertain |=
        (kept.plane >= 0 && std::fabs(from_begin) <= begin_error) || std::fabs(from_end) <= end_error;
    if (beyond && from_end > end_error && first == kNoIndex) first = i;
    if (crossing.solid == kNoIndex) continue;
    auto count = std::find_if(counts_.begin(), counts_.end(),
                              [&](const Count& c) { return c.solid == crossing.solid; });
    if (count == counts_.end()) count = counts_.insert(counts_.end(), {crossing.solid, false, false});
    count->odd = !count->odd;
    count->odd_beyond = count->odd_beyond != beyond;
  }

  // If there is a cap, it is nearer than every kept crossing.
  std::uint32_t inside = kNoIndex;
  for (const Count& count : counts_) {
    answer.odd |= count.odd;
    if (count.odd_beyond) inside = std::min(inside, count.solid);
  }
  if (kept.plane >= 0 && inside != kNoIndex) {
    answer.kind = SectionAnswer::Kind::kCap;
    answer.index = inside;
  } else if (first != kNoIndex) {
    answer.kind = SectionAnswer::Kind::kCrossing;
    answer.index = first;
  }
  return answer;
}

}  // namespace facetless
