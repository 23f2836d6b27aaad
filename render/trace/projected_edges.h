// The rule for hits near shared edges. Within the band of an edge, both faces decide by the same question: on
// which side of the shared 3D edge, projected along the ray, does the ray pass? Both get the same answer, so
// their decisions are exactly complementary.
//
//     const ProjectedEdges edges(model, instance.placement, frame);
//     const EdgeDecision decision = DecideAtEdge(model, edges, answer, x, y, mm_per_px, jacobian_positive);
//     if (decision.verdict == EdgeVerdict::kUnknown) inside = answer.inside;
//
//  1. Sides are defined algebraically, in pixel coordinates (x to the right, y down). kPositive means
//     cross(T, P − C) = Tx·(P − C)y − Ty·(P − C)x > 0, where C is the projected point of the edge that is
//     locally nearest to the pixel P, and T the direction of increasing edge parameter there. (On the screen,
//     with y down, kPositive is to the right of the edge.)
//  2. The nearest point is found from the guess and then rounded to a fixed grid of the edge's parameter, so
//     that two guesses that lead to the same point give bit-identical answers. It is clamped at the ends of
//     an open edge; beyond an end, the tangent line there determines the side. A closed edge (equal vertices)
//     has no ends. At a kink, both tangent lines decide, as at a corner.
//  3. Nothing is stored per edge. Each query projects the segments that it needs, in the same way as patches
//     are projected.
//  4. The side is kUnknown if the edge has no curve, if its nearest point is not in front of the eye, or if
//     the derivative of its projection vanishes.
//  5. The results are deterministic; sqrt is the only libm function used.
//
// At a corner, two coedges of one loop meet. The material of each lies in a half plane bounded by its tangent
// line. If the corner is convex in the image, the face contains the pixel iff both half planes do; if it is
// reflex, iff at least one of them does. Around a vertex, each tangent line is used by the two faces beside
// its edge, so the wedges of a fan of faces tile the image without overlap or gap.
#pragma once

#include <cstdint>

#include "render/model/model.h"
#include "render/nurbs/trim_index.h"
#include "render/view/camera.h"
#include "render/view/projection.h"

namespace facetless {

enum class Side : std::int8_t { kNegative = -1, kUnknown = 0, kPositive = 1 };

struct EdgeSide {
  Side side = Side::kUnknown;
  double distance_px =
      0;  // distance from the pixel to the nearest point, >= 0; for kUnknown, this and all other members are undefined
  double parameter = 0;  // edge parameter of the nearest point
  Vec2 tangent;          // tangent of the projected edge there, pixels per unit of edge parameter
  double error_px =
      0;  // bound of the rounding error of the projected edge; a side is proven only beyond this distance
};

class ProjectedEdges {
 public:
  // The edges of the part that `placement` places, seen through `frame`. `model` must outlive this object.
  ProjectedEdges(const Model& model, const Placement& placement, const CameraFrame& frame);

  const Model& model() const { return *model_; }
  // Projects a homogeneous point of the part to (X·W, Y·W, W), where X and Y are its pixel coordinates
  // relative to (x, y).
  Vec3 Relative(const Vec4& point, double x, double y) const;

  // The side of `edge` on which the pixel coordinates (x, y) lie. The search for the nearest point starts at
  // the edge parameter `guess`.
  EdgeSide SideOf(std::uint32_t edge, double guess, double x, double y) const;

  // The tangent of the projected edge at `parameter`, in pixels per unit of edge parameter, on the segment
  // that ends there (`ending`) or that begins there. It is (0,0) in the cases of law 4.
  Vec2 TangentAt(std::uint32_t edge, double parameter, bool ending) const;

 private:
  class Segment;

  const Model* model_;
  ViewProjection projection_;
  double center_x_, center_y_;  // centre of the image, in pixel coordinates
};

// Returns whether a hit is kept, judged by one coedge alone. `jacobian_positive`: x_u·y_v − x_v·y_u > 0 for
// the map (u,v) -> pixel at the hit. Requires side != kUnknown.
bool EdgeKeepsHit(const Coedge& coedge, bool material_left, Side side, bool jacobian_positive);

enum class EdgeVerdict : std::uint8_t { kKeep, kDrop, kUnknown };

struct EdgeDecision {
  EdgeVerdict verdict = EdgeVerdict::kUnknown;
  bool proven = true;  // every side that was used is proven beyond the error of the projected edge
};

// Applies the rule to a trim answer with a coedge: to one edge, or to the two edges of a corner. `mm_per_px`
// is the size of a pixel at the depth of the hit. kUnknown means that answer.inside decides, because the side
// is unknown or because the ray passes the edge at more than its gap.
EdgeDecision DecideAtEdge(const Model& model, const ProjectedEdges& edges, const TrimAnswer& answer, double x,
                          double y, double mm_per_px, bool jacobian_positive);

}  // namespace facetless
