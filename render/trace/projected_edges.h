// The per-view rule at shared edges: within an edge's band both faces ask on which side of the shared 3D
// edge, projected along the ray, the ray passes. Both get the same answer, so their decisions are exactly
// complementary.
//
//  1. Sides are algebraic, in pixel coordinates (x to the right, y down): kPositive means cross(T, P − C) =
//     Tx·(P − C)y − Ty·(P − C)x > 0, with C the edge's projected point locally nearest to the pixel P and T
//     the direction of increasing edge parameter there. (On the screen, with y down, that is to the right of
//     the edge.)
//  2. The nearest point is found from the guess and then rounded to a fixed grid of the edge's parameter: two
//     guesses that lead to one foot give bit-identical answers. It is clamped at the ends of an open edge;
//     beyond an end the side is that of the tangent line there. A closed edge (equal vertices) has no ends.
//     At a kink both tangent lines decide, as at a corner.
//  3. Nothing is stored per edge: a question projects the segments that it meets, as patches are projected.
//  4. kUnknown where the edge has no curve, where its nearest point isn't in front of the eye, or where its
//     projection stands still.
//  5. Deterministic: no libm but sqrt.
//
// At a corner two coedges of one loop meet, each with the half plane of its material beyond its tangent line.
// The face holds the pixel iff both half planes do when the corner is convex in the image, and iff one of
// them does when it is reflex. Around a vertex each edge's line is asked by the two faces beside it, so the
// wedges of a fan of faces tile the image without overlap or gap.
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
      0;                 // from the pixel to the nearest point, >= 0; meaningless for kUnknown, like the rest
  double parameter = 0;  // of the nearest point, on the edge
  Vec2 tangent;          // of the projected edge there, pixels per unit of edge parameter
  double error_px =
      0;  // how far rounding may have moved the projected edge: nearer than that, no side is proven
};

class ProjectedEdges {
 public:
  // Of the part that `placement` places, seen through `frame`. `model` must outlive it.
  ProjectedEdges(const Model& model, const Placement& placement, const CameraFrame& frame);

  const Model& model() const { return *model_; }
  // A homogeneous point of the part as (x·W, y·W, W), with x and y its pixel coordinates relative to (x, y).
  Vec3 Relative(const Vec4& point, double x, double y) const;

  // On which side of `edge` the pixel coordinates (x, y) lie, by the point locally nearest to them from
  // `guess` on.
  EdgeSide SideOf(std::uint32_t edge, double guess, double x, double y) const;

  // The projected edge's direction at `parameter`, pixels per unit of edge parameter, by the segment that
  // ends there (`ending`) or begins. (0,0) where law 4 says kUnknown.
  Vec2 TangentAt(std::uint32_t edge, double parameter, bool ending) const;

 private:
  class Segment;

  const Model* model_;
  ViewProjection projection_;
  double center_x_, center_y_;  // of the image, in pixel coordinates
};

// Whether a hit counts by one coedge alone. `jacobian_positive`: x_u·y_v − x_v·y_u > 0 for the map (u,v) ->
// pixel at the hit. Requires side != kUnknown.
bool EdgeKeeps(const Coedge& coedge, bool material_left, Side side, bool jacobian_positive);

enum class EdgeVerdict : std::uint8_t { kKeep, kDrop, kUnknown };

struct EdgeDecision {
  EdgeVerdict verdict = EdgeVerdict::kUnknown;
  bool proven = true;  // every side that was asked for lies beyond the error of its edge's projection
};

// The whole rule for a trim answer with a coedge: one edge, or the two of a corner. `mm_per_px`: the size of
// a pixel at the hit's depth. kUnknown: go by answer.inside, because the edge can't say, or because the ray
// passes it farther off than its gap.
EdgeDecision DecideAtEdge(const Model& model, const ProjectedEdges& edges, const TrimAnswer& answer, double x,
                          double y, double mm_per_px, bool jacobian_positive);

}  // namespace facetless
