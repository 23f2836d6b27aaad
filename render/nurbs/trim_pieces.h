// From a face's loops to monotone pieces: what the trim index is built of.
//
//  1. Pieces stand in loop order; each starts with the very bits that the one before ends with, the last one
//     of a loop ends with those of the first. Where two segments' ends differ by more than rounding, a
//     straight piece joins them.
//  2. A coedge's band is a half-width per piece: the largest along it, of (u,v) for a distance of gap_mm plus
//     the rounding of a surface point. Where the surface degenerates it is as wide as the patch grid. Pieces
//     along which it changes much are cut.
//  3. A slit, two coedges of one edge that run to and fro along one curve, bounds nothing: both get the same
//     pieces, in opposite order, so that their crossings cancel bit by bit, and no band.
//  4. A degenerate edge and a border without an edge have no band, and no edge to ask.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/monotone_curve.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {

// What a query reads of every piece that it opens: 64 bytes. `low` is the end with the smaller v.
struct TrimPiece {
  Vec2 low, high;
  double strip_low = 0,
         strip_high = 0;  // cross(high − low, c − low) lies between them for every point c of the curve
  float band_u = 0, band_v = 0;     // at band_scale 1, rounded up
  std::uint32_t coedge = kNoIndex;  // to ask; kNoIndex: no edge
  bool forward = true;              // runs in loop order from low to high
  bool slit = false;                // law 3
};

// The rest: read when the strip can't tell, or the nearest coedge is wanted.
struct TrimPieceCurve {
  std::uint32_t first_point = 0;  // into TrimPieces::points
  std::uint32_t degree = 1;
  double t_low = 0, t_high = 1;
  Vec2 error;
  double edge_begin = 0, edge_end = 0;  // edge parameters at t = 0 and t = 1 of the curve
  double reach_mm = 0;                  // gap plus rounding: what the band stands for
};

struct TrimPieces {
  std::vector<TrimPiece> pieces;
  std::vector<TrimPieceCurve> curves;     // one per piece
  std::vector<Vec3> points;               // (w·u, w·v, w)
  std::vector<std::uint32_t> loop_first;  // first piece of each loop; ends with pieces.size()

  MonotonePiece Monotone(std::size_t piece) const;
  Vec2 Begin(std::size_t piece) const {
    return pieces[piece].forward ? pieces[piece].low : pieces[piece].high;
  }
  Vec2 End(std::size_t piece) const { return pieces[piece].forward ? pieces[piece].high : pieces[piece].low; }
};

// Requires a valid model and face < model.faces.size(). A face without loops gets the border of its patch
// grid.
TrimPieces MakeTrimPieces(const Model& model, std::uint32_t face, const SurfaceEval& surface);

}  // namespace facetless
