// The oracle: every intersection of a ray with the surfaces of a model, in extended precision, slowly. It
// shares no code with the renderer; of render/ it knows the Model's data only.
//
//  1. Surfaces are the model's Bézier patches, taken as exact. FindRoots gives all roots of a ray on each
//     patch, proven or as a doubt; roots that neighbouring patches find on a common border are one crossing,
//     if both turn the same way: where one turns away, the border is a silhouette, and a ray meets both or
//     none.
//  2. Whether a crossing is inside its face is even-odd, over the face's p-curves in native parameters: the
//     half-line from the point towards +v. A face without loops is its whole patch grid. A point on the
//     border of its patch counts as inside the patch by kInwards.
//  3. A crossing is kUnsure where its root is in doubt, where it lies beyond its patch (by at most kOverlap),
//     or where a p-curve passes through it.
//  4. The renderer asks neighbouring faces the same question near a shared edge: on which side of the edge's
//     3D curve the ray passes, instead of the p-curve. NearestEdge says how near that curve is to the ray,
//     and what gap the model records for it: within the gap either answer is the file's own doing, and which
//     one is right is for the rule of render/trace/projected_edges.h to say, not for the oracle.
//  5. Distances to curves are across the ray, in mm: from the crossing to the p-curve as the surface's
//     tangent plane shows it, or from the ray to the point of the edge.
//  6. Immutable; any number of threads may ask.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "tests/verify/oracle/plane_curves.h"
#include "tests/verify/oracle/view_ray.h"

namespace facetless::oracle {

// A point on a patch's border is moved into it by this share of its side before the p-curves are asked: the
// border belongs to the patch, whatever rounding did to the root. It is finer than any p-curve's own
// rounding.
inline constexpr double kInwards = 0x1p-80;

enum class Standing : std::uint8_t { kInside, kOutside, kUnsure };

struct Crossing {
  std::uint32_t placed_face = 0, patch = 0;
  bool proven = false;
  Real depth = 0, half_depth = 0;  // within depth ± half_depth
  Real u = 0, v = 0;               // native parameters
  Real border = 0;                 // of the patch's own parameters to 0 or 1; negative beyond the patch
  Standing standing = Standing::kUnsure;
  double cosine = 0;                         // |N·D|; 0 where the surface has no normal
  int turns = 0;                             // the sign of N·D, with N = ∂u × ∂v
  double tangents[2][2] = {{0, 0}, {0, 0}};  // mm along ViewRay::across and down per unit of native u and v
};

struct EdgeContact {
  std::uint32_t coedge = kNoIndex;  // kNoIndex: the face has no edge near the ray
  double distance_mm = 0, gap_mm = 0;
  double depth = 0;  // of the edge's nearest point
};

class Oracle {
 public:
  // Requires a valid model, which must outlive the oracle.
  explicit Oracle(const Model& model);

  // All crossings farther than `near` along the ray, nearest first.
  std::vector<Crossing> Crossings(const ViewRay& ray, double near) const;

  // Distance to the nearest p-curve that bounds the face (not to a seam, nor to a collapsed edge), if it is
  // below `limit_mm`, else infinity.
  double TrimDistance(const Crossing& crossing, double limit_mm) const;

  // Of the face's edges that the ray passes within their gap plus `slack_mm`, and whose nearest point has a
  // depth within `depth_reach` of `depth`: the one with the least distance less gap.
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
  std::vector<Box3> boxes_;          // of the placed faces, with slack
  std::vector<TrimBox> trim_boxes_;  // of the trim segments
};

}  // namespace facetless::oracle
