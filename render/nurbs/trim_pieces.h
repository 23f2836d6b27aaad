// The loops of a face, divided into monotone pieces, from which the trim index is built.
//
//  1. Pieces are in loop order. Each piece starts with exactly the same bits with which the previous piece
//     ends, and the last piece of a loop ends where the first starts. If the ends of two segments differ by
//     more than rounding, a straight piece joins them.
//  2. The band of a coedge is stored as a half-width per piece: the largest change of (u,v), along the piece,
//     that corresponds to a distance of gap_mm plus the rounding error of a surface point. Where the surface
//     is degenerate, the band is as wide as the patch grid. Pieces along which the width varies much are
//     divided.
//  3. A slit consists of two coedges of one edge that run along the same curve in opposite directions. It
//     bounds nothing. Both coedges get the same pieces in opposite order, so that their crossings cancel
//     exactly, and they have no band.
//  4. A degenerate edge, and a border without an edge, have no band and no edge for queries to report.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.h"
#include "render/nurbs/monotone_curve.h"
#include "render/nurbs/surface_eval.h"

namespace facetless {

// The 64 bytes that a query reads for every piece it opens. `low` is the end with the smaller v.
struct TrimPiece {
  Vec2 low, high;
  double strip_low = 0,
         strip_high = 0;  // cross(high − low, c − low) lies between them for every point c of the curve
  float band_u = 0, band_v = 0;     // at band_scale 1, rounded up
  std::uint32_t coedge = kNoIndex;  // coedge to report; kNoIndex: there is no edge
  bool forward = true;              // true: the loop runs from low to high
  bool slit = false;                // law 3
};

// The other data of a piece, read if the strip cannot decide or if the nearest coedge is needed.
struct TrimPieceCurve {
  std::uint32_t first_point = 0;  // into TrimPieces::points
  std::uint32_t degree = 1;
  double t_low = 0, t_high = 1;
  Vec2 error;
  double edge_begin = 0, edge_end = 0;  // edge parameters at t = 0 and t = 1 of the curve
  double reach_mm = 0;                  // gap plus rounding error: the distance to which the band corresponds
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

// Divides the loops of a face into pieces. Requires a valid model and face < model.faces.size(). A face
// without loops gets the border of its patch grid.
TrimPieces MakeTrimPieces(const Model& model, std::uint32_t face, const SurfaceEval& surface);

}  // namespace facetless
