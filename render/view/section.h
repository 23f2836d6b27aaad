// Section planes: what a view shows of a model that is cut open. No boundary representation is changed; every
// ray decides for itself.
//
//  1. A plane removes the side that its normal points to. Of several planes, what is kept is the intersection
//     of the kept sides: along a ray an interval of depths.
//  2. What is kept of a closed solid is closed again: where a ray enters the kept interval inside a closed
//     solid, it meets the plane's *cap* there. Inside is said by parity: the solid is crossed an odd number
//     of times beyond that point. Each placed solid counts for itself; where several overlap, the cap is that
//     of the lowest id.
//  3. Faces of no closed solid are cut, and have no cap.
//  4. A crossing that no number tells from the plane belongs to the removed side. A face that lies in a plane
//     is thus replaced by the cap of what it bounds on the kept side, or leaves nothing.
//  5. Caps have face ids of their own, above those of the placed faces: one for each plane and placed solid.
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

// kBadUsage: more planes than that, a normal that is no unit vector, a point that is not finite or nearly
// not.
Result<void> CheckSections(std::span<const SectionPlane> planes);

// The placed solids of a model, numbered by instance and solid, and the ids of their caps.
class SectionSolids {
 public:
  explicit SectionSolids(const Model& model);

  std::uint32_t count() const { return static_cast<std::uint32_t>(solids_.size()); }
  // The closed placed solid that the face belongs to; kNoIndex where there is none.
  std::uint32_t SolidOf(std::uint32_t placed_face) const { return solid_of_face_[placed_face]; }
  std::string Name(std::uint32_t solid) const;
  Color ColorOf(std::uint32_t solid) const;  // that most of its faces have

  std::uint32_t first_cap() const { return static_cast<std::uint32_t>(solid_of_face_.size()); }
  std::uint32_t CapId(int plane, std::uint32_t solid) const {
    return first_cap() + static_cast<std::uint32_t>(plane) * stride() + solid;
  }
  // Of a cap's id. There is at least one solid to speak of, so that meshes of no model have caps, too.
  std::uint32_t stride() const { return count() > 0 ? count() : 1; }

 private:
  struct PlacedSolid {
    std::uint32_t instance, solid;
  };
  const Model* model_;
  std::vector<PlacedSolid> solids_;
  std::vector<std::uint32_t> solid_of_face_;
};

// What the planes keep of a ray.
struct KeptInterval {
  double begin = -INFINITY, end = INFINITY;  // depths; begin >= end: nothing
  double begin_error = 0, end_error = 0;     // of the two, mm
  int plane = -1;                            // through which it begins; −1: none
};
// Of the ray's depths beyond `near_depth`.
KeptInterval KeptOf(const Ray& ray, std::span<const SectionPlane> planes, double near_depth);

// A crossing of a ray, as far as sections ask.
struct SolidCrossing {
  double depth, error;
  std::uint32_t solid;  // kNoIndex: of no closed solid
};

struct SectionAnswer {
  enum class Kind : std::uint8_t { kMiss, kCap, kCrossing };
  Kind kind = Kind::kMiss;
  std::uint32_t index = 0;  // of the crossing, or of the cap's solid
  bool uncertain = false;   // a crossing lies within its error of a plane
  bool odd = false;         // some solid is crossed an odd number of times by the whole ray
};

// Keeps the storage of what it counts from ray to ray.
class SectionDecision {
 public:
  // `crossings` by ascending depth.
  SectionAnswer Decide(std::span<const SolidCrossing> crossings, const KeptInterval& kept);

 private:
  struct Count {
    std::uint32_t solid;
    bool odd_beyond, odd;
  };
  std::vector<Count> counts_;
};

}  // namespace facetless
