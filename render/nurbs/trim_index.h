// The trim index of one face: which part of the patch grid belongs to the face, in native parameters (u,v).
//
//  1. Inside is even-odd: a point is inside if the half-line from it towards +u crosses the loops an odd
//     number of times. The sense of a loop doesn't matter, so wrongly oriented loops of real files still
//     work; which side of each coedge holds material is derived from the same counting
//     (TrimAnswer::material_left), not from the file.
//  2. Pieces of a loop share bit-identical end points, and a crossing is counted by the half-open rule v_low
//     <= v < v_high on them: every point off the curves has one well-defined answer, whatever the pieces'
//     shapes.
//  3. Classify is conservative: kInside and kOutside are proven for the whole rectangle, its distance to
//     every coedge exceeding that coedge's band. Query never contradicts it.
//  4. A coedge's *band* is where the surface point may lie within Coedge::gap_mm (plus the rounding of a
//     surface point) of the p-curve, measured on the surface. `band_scale` widens it: seen at the angle a to
//     the normal, a gap of g mm covers g/cos a mm of the surface, so the caller passes 1/|N·D|, capped as it
//     likes. 0 takes the bands away.
//  5. Immutable once built; queries are const, allocate nothing and may run in any number of threads. The
//     same arguments give the same bits on every machine: no libm but sqrt.
//
// Structure: each loop is a chain of pieces monotone in u and in v (render/nurbs/trim_pieces.h). A tree of
// nodes with up to eight children over consecutive pieces stores the box and the two ends of every stretch of
// chain. A stretch whose box is clear of the query counts by its two ends alone, so a query opens only the
// boxes that contain it; at a piece the side is known from the strip around its chord, or else from a root of
// its curve.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/trim_pieces.h"

namespace facetless {

enum class RectClass : std::uint8_t { kInside, kOutside, kMixed };

// The most expensive test that an answer needed.
enum class TrimPath : std::uint8_t {
  kBoxes,  // boxes and end points of stretches of chain
  kStrip,  // the strip around a piece's chord
  kCurve,  // a root of a piece's curve
};

struct TrimAnswer {
  bool inside = false;        // by the p-curves, even-odd
  bool certain = true;        // no p-curve meets the error box, evaluation's rounding included
  bool material_left = true;  // the face lies on the left of `coedge` in (u,v), looking along its p-curve
  bool other_material_left = true;  // the same for other_coedge
  TrimPath path = TrimPath::kBoxes;
  std::uint32_t coedge = kNoIndex;  // nearest coedge (Model::coedges) whose band, grown by the error box,
                                    // holds (u,v), and that has a 3D edge; kNoIndex: none
  std::uint32_t other_coedge =
      kNoIndex;                // at a corner: its neighbour in the loop; kNoIndex away from corners
  bool other_is_next = false;  // other_coedge follows `coedge` in the loop; false: it comes before
  double edge_parameter = 0;   // the matching parameter of `coedge`'s edge; 0 if there is none
  double other_edge_parameter = 0;
};

class FaceTrim {
 public:
  // Requires a valid Model and face < model.faces.size(). A face without loops gets the border of its patch
  // grid as one. Ends of consecutive segments that differ are joined by a straight piece that belongs to the
  // earlier one's coedge.
  static FaceTrim Build(const Model& model, std::uint32_t face);

  // Where the closed rectangle u0 <= u <= u1, v0 <= v <= v1 lies. Requires u0 <= u1, v0 <= v1, finite; kMixed
  // if not.
  RectClass Classify(double u0, double u1, double v0, double v1, double band_scale = 1) const;

  // Whether (u,v) is inside, (u,v) being known to within ±error_u, ±error_v. Errors >= 0; (u,v) finite: else
  // outside, not certain.
  TrimAnswer Query(double u, double v, double error_u, double error_v, double band_scale = 1) const;

  // The loops are the border of the patch grid: whatever lies inside the grid and out of the bands is inside.
  bool whole() const { return whole_; }

  std::size_t bytes() const;
  std::size_t piece_count() const { return pieces_.pieces.size(); }

 private:
  static constexpr int kWidth = 8;

  // Up to eight stretches of chain. Unused lanes have an empty box.
  struct alignas(64) Node {
    double u_low[kWidth], u_high[kWidth], v_low[kWidth], v_high[kWidth];  // boxes, rounding included
    double v_begin[kWidth], v_end[kWidth];                                // of the stretch's two ends
    std::uint32_t child[kWidth];   // by child, not by lane: a node, or a piece with kPieceBit
    float band_u = 0, band_v = 0;  // widest of all pieces below
    std::uint32_t count = 0;
  };
  struct Ends {  // of a coedge, in its loop
    std::uint32_t previous = kNoIndex,
                  next = kNoIndex;  // neighbours, collapsed ones skipped; kNoIndex: no edge to ask
    double begin = 0, end = 0;      // edge parameters
    Vec2 begin_point, end_point;
    bool material_left = true;
  };
  struct Rect {
    double u_low, u_high, v_low, v_high;
  };
  enum class PieceSide : std::uint8_t { kLeft, kRight, kMeets };
  struct Stretch;
  struct Builder;
  struct Contacts;

  template <typename OpenPiece>
  bool Walk(Vec2 point, const Rect& rect, double band_scale, bool& odd, const OpenPiece& open_piece) const;
  PieceSide SideOfRect(std::uint32_t piece, const Rect& rect, double band_scale, TrimPath& path) const;
  bool CrossesRightOf(std::uint32_t piece, Vec2 point, TrimPath& path) const;
  bool OddExcept(Vec2 point, std::uint32_t excluded) const;
  bool MaterialLeft(std::uint32_t piece) const;
  void FindNeighbours(const Model& model, const Face& face);
  void FindEndsAndMaterial();
  void FindWhole(const SurfaceEval& surface);

  TrimPieces pieces_;
  std::vector<Node> nodes_;         // the root is the last; none: no loops
  std::uint32_t first_coedge_ = 0;  // ends_[i] is of coedge first_coedge_ + i
  std::vector<Ends> ends_;
  bool whole_ = false;
};

}  // namespace facetless
