// The trim index of one face. It decides which part of the patch grid belongs to the face, in native
// parameters (u,v).
//
//     const FaceTrim trim = FaceTrim::Build(model, face);
//     const TrimAnswer answer = trim.Query(u, v, error_u, error_v);
//     if (answer.inside && answer.certain) ++hits;
//
//  1. The inside is defined by the even-odd rule: a point is inside if the half-line from it towards +u
//     crosses the loops an odd number of times. The sense of a loop has no effect, so the wrongly oriented
//     loops of real files work, too. The side of each coedge on which the material lies
//     (TrimAnswer::material_left) is derived from the same rule, not from the file.
//  2. Consecutive pieces of a loop share bit-identical end points, and crossings are counted by the half-open
//     rule v_low <= v < v_high on them. Every point that is not on a curve therefore has one well-defined
//     answer, whatever the shapes of the pieces.
//  3. Classify is conservative: kInside and kOutside are proven for the whole rectangle, whose distance from
//     every coedge exceeds the band of that coedge. Query never contradicts Classify.
//  4. The *band* of a coedge is the region in which the surface point may lie within Coedge::gap_mm (plus the
//     rounding error of a surface point) of the p-curve, measured on the surface. `band_scale` widens the
//     band: seen at the angle a to the normal, a gap of g mm covers g/cos a mm of the surface, so the caller
//     passes 1/|N·D|, limited as it chooses. A band_scale of 0 removes the bands.
//  5. A FaceTrim is immutable once it is built. Queries are const, allocate nothing, and may run in any
//     number of threads. The same arguments give the same bits on every machine; sqrt is the only libm
//     function used.
//
// Structure: each loop is a chain of pieces that are monotone in u and in v (render/nurbs/trim_pieces.h). A
// tree with up to eight children per node is built over consecutive pieces; it stores the box and the two
// ends of every run of pieces. If the query lies outside the box of a run, the two ends of the run decide the
// crossing, so a query opens only the boxes that contain it. At a single piece, the strip around its chord
// decides the side, or else a root of its curve.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/trim_pieces.h"
#include "render/nurbs/trim_window.h"

namespace facetless {

enum class RectClass : std::uint8_t { kInside, kOutside, kMixed };

// The most expensive test that was needed for an answer.
enum class TrimPath : std::uint8_t {
  kBoxes,  // boxes and end points of runs of pieces
  kStrip,  // the strip around a piece's chord
  kCurve,  // a root of a piece's curve
};

struct TrimAnswer {
  bool inside = false;        // by the p-curves, even-odd
  bool certain = true;        // no p-curve meets the error box, rounding of the evaluation included
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

// A line through a rectangle of parameters, in coordinates s and t that run from −1 to 1 over the rectangle. Points
// with a·s + b·t + c > w are inside the face; points with a·s + b·t + c < −w are trimmed away. If w is infinite, the
// line decides nothing.
struct TrimLine {
  double a = 0, b = 0, c = 0, w = INFINITY;
  static TrimLine Whole() { return {0, 0, 1, 0}; }  // the whole rectangle is inside
};

class FaceTrim {
 public:
  // Builds the index of a face. Requires a valid model and face < model.faces.size(). A face without loops
  // gets the border of its patch grid as its loop. If the ends of consecutive segments differ, a straight
  // piece joins them; it belongs to the coedge of the earlier segment.
  static FaceTrim Build(const Model& model, std::uint32_t face);

  // Classifies the closed rectangle u0 <= u <= u1, v0 <= v <= v1. The answer is kMixed if the bounds are not
  // finite or not ordered.
  RectClass Classify(double u0, double u1, double v0, double v1, double band_scale = 1) const;

  // Returns a line that divides the rectangle into a part inside the face and a part that is trimmed away. All p-curves
  // that meet the rectangle, with their bands, are proven to lie within w of the line. w is infinite if there are too
  // many of them, or if they do not divide the rectangle into an inner and an outer part. Implemented in
  // trim_line.cpp.
  TrimLine FindLine(double u0, double u1, double v0, double v1, double band_scale) const;

  // Decides whether (u,v), which is known to within ±error_u, ±error_v, is inside. Requires errors >= 0. If
  // (u,v) is not finite, the answer is outside and not certain.
  TrimAnswer Query(double u, double v, double error_u, double error_v, double band_scale = 1) const;

  // The window of all queries in u0 <= u <= u1, v0 <= v <= v1, errors included, with bands of up to `band_scale`. It
  // holds no query if too many pieces lie in the rectangle.
  TrimWindow WindowOf(double u0, double u1, double v0, double v1, double band_scale) const;
  // The same as Query without a window. Requires a window of this index.
  TrimAnswer Query(const TrimWindow& window, double u, double v, double error_u, double error_v,
                   double band_scale) const;

  // Returns whether the loops are the border of the patch grid. If so, every point inside the grid and
  // outside the bands is inside the face.
  bool whole() const { return whole_; }

  std::size_t bytes() const;
  std::size_t piece_count() const { return pieces_.pieces.size(); }

 private:
  static constexpr int kWidth = 8;
  static constexpr std::uint32_t kPieceBit = 0x80000000u;

  // Up to eight runs of consecutive pieces. Unused lanes have an empty box.
  struct alignas(64) Node {
    double u_low[kWidth], u_high[kWidth], v_low[kWidth], v_high[kWidth];  // boxes, rounding included
    double v_begin[kWidth], v_end[kWidth];                                // v of the two ends of each run
    std::uint32_t child[kWidth];   // indexed by child, not by lane: a node, or a piece with kPieceBit
    float band_u = 0, band_v = 0;  // widest band of all pieces below
    std::uint32_t count = 0;
  };
  // The lane of child i in a node. Children i and i + 4 share a pair of lanes.
  static std::uint32_t ChildLane(std::uint32_t i) { return 2 * (i % 4) + i / 4; }
  struct Ends {  // the ends of a coedge in its loop
    std::uint32_t
        previous = kNoIndex,
        next = kNoIndex;  // neighbouring coedges, without collapsed ones; kNoIndex: the neighbour has no edge
    double begin = 0, end = 0;  // edge parameters
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
  // Lists the pieces whose boxes, with their bands, meet the rectangle. Returns false if they are more than `most`.
  bool PiecesIn(const Rect& rect, double band_scale, int most, std::uint32_t* found, int* count) const;
  template <typename WalkPieces>
  TrimAnswer Answer(Vec2 point, Vec2 error, const Rect& rect, double band_scale,
                    const WalkPieces& walk) const;
  // Adds the runs below node `index`. Returns false if there is no room.
  bool AddToWindow(std::uint32_t index, TrimWindow* window) const;
  PieceSide SideOfRect(std::uint32_t piece, const Rect& rect, double band_scale, TrimPath& path) const;
  bool CrossesRayTowardsU(std::uint32_t piece, Vec2 point, TrimPath& path) const;
  bool OddExcept(Vec2 point, std::uint32_t excluded) const;
  bool MaterialLeft(std::uint32_t piece) const;
  void FindNeighbours(const Model& model, const Face& face);
  void FindEndsAndMaterial();
  void FindWhole(const SurfaceEval& surface);

  TrimPieces pieces_;
  std::vector<Node> nodes_;         // the root is the last node; empty if there are no loops
  std::uint32_t first_coedge_ = 0;  // ends_[i] belongs to coedge first_coedge_ + i
  std::vector<Ends> ends_;
  bool whole_ = false;
};

}  // namespace facetless
