// The oracle finds every intersection of a ray with the surfaces of a model, in extended precision, slowly.
// It shares no code with the renderer, and uses only the data of Model from render/.
//
//  1. Surfaces are the model's Bézier patches, which are taken as exact. FindRoots gives all roots of a ray
//     on each patch, either proven or as a doubt. Roots that neighbouring patches find on a common border are
//     one crossing if both turn in the same direction. If one turns away, the border is a silhouette, and a
//     ray meets both or none.
//  2. Whether a crossing is inside its face is decided by the even-odd rule on the face's p-curves in native
//     parameters, along the half-line from the point towards +v. A face without loops is its whole patch
//     grid. A point on the border of its patch counts as inside the patch by kInwards.
//  3. A crossing is kUnsure if its root is in doubt, if it lies beyond its patch (by at most kOverlap), or if
//     a p-curve passes through it.
//  4. Near a shared edge, the renderer decides neighbouring faces by the same question: on which side of the
//     edge's 3D curve the ray passes. It does not use the p-curve there. NearestEdge returns the distance of
//     that curve from the ray and the gap that the model records for it. Within the gap the file permits
//     either answer, and which one is right is defined by render/trace/projected_edges.h, not by the oracle.
//  5. Distances to curves are across the ray, in mm: from the crossing to the p-curve as the surface's
//     tangent plane shows it, or from the ray to the point of the edge.
//  6. The object is immutable. Any number of threads may use it.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "tests/verify/oracle/plane_curves.h"
#include "tests/verify/oracle/view_ray.h"

namespace facetless::oracle {

// A point on a patch's border is moved into the patch by this share of its side before the p-curves are
// tested: the border belongs to the patch, however the root was rounded. The distance is smaller than any
// p-curve's own rounding.
inline constexpr double kInwards = 0x1p-80;

enum class Standing : std::uint8_t { kInside, kOutside, kUnsure };

struct Crossing {
  std::uint32_t placed_face = 0, patch = 0;
  bool proven = false;
  Real depth = 0, half_depth = 0;  // within depth ± half_depth
  Real u = 0, v = 0;               // native parameters
  Real border = 0;  // distance of the patch's own parameters to 0 or 1; negative beyond the patch
  Standing standing = Standing::kUnsure;
  double cosine = 0;                         // |N·D|; 0 if the surface has no normal
  int turns = 0;                             // the sign of N·D, with N = ∂u × ∂v
  double tangents[2][2] = {{0, 0}, {0, 0}};  // mm along ViewRay::across and down per unit of native u and v
};

struct EdgeContact {
  std::uint32_t coedge = kNoIndex;  // kNoIndex: the face has no edge near the ray
  double distance_mm = 0, gap_mm = 0;
  double depth = 0;  // depth of the edge's nearest point
};

class Oracle {
 public:
  // Requires a valid model, which must outlive the oracle.
  explicit Oracle(const Model& model);

  // Returns all crossings farther than `near` along the ray, the nearest first.
  std::vector<Crossing> Crossings(const ViewRay& ray, double near) const;

  // Returns the distance to the nearest p-curve that bounds the face (ignoring seams and collapsed edges) if
  // it is below `limit_mm`, else infinity.
  double TrimDistance(const Crossing& crossing, double limit_mm) const;

  // Considers the face's edges that the ray passes within their gap plus `slack_mm`, and whose nearest point
  // has a depth within `depth_reach` of `depth`. Returns the one with the smallest distance less gap.
  EdgeContact NearestEdge(const ViewRay& ray, std::uint32_t placed_face, double depth, double slack_mm,
                          double depth_reach) const;

  const Model& model() const { return model_; }

 private:
  struct TrimBox {
    double u_low, u_high, v_high;
  };
  void FaceCrossings(const ViewRay& ray, double near, std::uint32_t placed_face,
                     std::vector<Crossing>& found) const;
  Standing ClassifyTrimPoint(std::uint32_t face, Real u, Real v) const;

  const Model& model_;
  std::vector<Box3> boxes_;          // boxes of the placed faces, with slack
  std::vector<TrimBox> trim_boxes_;  // boxes of the trim segments
};

}  // namespace facetless::oracle
