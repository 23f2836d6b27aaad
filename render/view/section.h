// Section planes, which cut a model open in a view. The boundary representation is not changed; the cut is
// decided separately for each ray.
//
//     const KeptInterval kept = ClipRayToSections(ray, planes, near_depth);
//     SectionDecision decision;
//     const SectionAnswer answer = decision.Decide(crossings, kept);
//     if (answer.kind == SectionAnswer::Kind::kCap) face = solids.CapId(kept.plane, answer.index);
//
//  1. A plane removes the side that its normal points to. Several planes keep the intersection of their kept
//     sides, which is an interval of depths along a ray.
//  2. The kept part of a closed solid is closed again: a ray that enters the kept interval inside a closed
//     solid meets the *cap* of the plane there. A point is inside a solid if the ray crosses the solid an odd
//     number of times beyond it. Each placed solid is counted separately; if several overlap, the cap belongs
//     to the one with the lowest id.
//  3. Faces that belong to no closed solid are cut, but have no cap.
//  4. A crossing that cannot be told apart from the plane counts as removed. A face that lies in a plane is
//     therefore replaced by the cap of the solid that it bounds on the kept side, or is not shown.
//  5. Caps have their own face ids, above those of the placed faces: one id for each plane and placed solid.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/base/result.h"
#include "render/model/model.h"
#include "render/view/camera.h"

namespace facetless {

struct SectionPlane {
  Vec3 point;
  Vec3 normal;  // unit
};

inline constexpr std::size_t kMostSectionPlanes = 16;

// Checks the planes. Errors: kBadUsage (more than kMostSectionPlanes planes, a normal that is not a unit
// vector, or a point that is not within 1e150 mm of the origin).
Result<void> CheckSections(std::span<const SectionPlane> planes);

// The placed solids of a model, numbered by instance and solid, and the ids of their caps.
class SectionSolids {
 public:
  explicit SectionSolids(const Model& model);

  std::uint32_t count() const { return static_cast<std::uint32_t>(solids_.size()); }
  // The closed placed solid to which the face belongs; kNoIndex if there is none.
  std::uint32_t ClosedSolidOfFace(std::uint32_t placed_face) const { return solid_of_face_[placed_face]; }
  std::string Name(std::uint32_t solid) const;
  Color ColorOf(std::uint32_t solid) const;  // the colour of most of its faces

  std::uint32_t first_cap() const { return static_cast<std::uint32_t>(solid_of_face_.size()); }
  std::uint32_t CapId(int plane, std::uint32_t solid) const {
    return first_cap() + static_cast<std::uint32_t>(plane) * stride() + solid;
  }
  // The difference between the cap ids of consecutive planes. It is at least 1, so that a mesh without a
  // model has cap ids, too.
  std::uint32_t stride() const { return count() > 0 ? count() : 1; }

 private:
  struct PlacedSolid {
    std::uint32_t instance, solid;
  };
  const Model* model_;
  std::vector<PlacedSolid> solids_;
  std::vector<std::uint32_t> solid_of_face_;
};

// The interval of a ray that the planes keep.
struct KeptInterval {
  double begin = -INFINITY, end = INFINITY;  // depths, mm; the interval is empty if begin >= end
  double begin_error = 0, end_error = 0;     // errors of begin and end, mm
  int plane = -1;                            // the plane at which the interval begins; −1: none
};
// The interval that the planes keep of the ray's depths beyond `near_depth`.
KeptInterval ClipRayToSections(const Ray& ray, std::span<const SectionPlane> planes, double near_depth);

// A crossing of a ray and a surface, with the data that sections need.
struct SolidCrossing {
  double depth, error;
  std::uint32_t solid;  // kNoIndex: the surface belongs to no closed solid
};

struct SectionAnswer {
  enum class Kind : std::uint8_t { kMiss, kCap, kCrossing };
  Kind kind = Kind::kMiss;
  std::uint32_t index = 0;  // index of the crossing, or of the solid to which the cap belongs
  bool uncertain = false;   // a crossing lies within its error of a plane
  bool odd = false;         // the whole ray crosses some solid an odd number of times
};

// Decides the result of one ray after another, and reuses its storage.
class SectionDecision {
 public:
  // Requires crossings that are sorted by ascending depth.
  SectionAnswer Decide(std::span<const SolidCrossing> crossings, const KeptInterval& kept);

 private:
  struct Count {
    std::uint32_t solid;
    bool odd_beyond, odd;
  };
  std::vector<Count> counts_;
};

}  // namespace facetless
