// A face's loops: its wires as closed chains of Bézier segments in the surface's native parameters.
//
//  1. Chains are closed bit by bit: a gap between two p-curves in the file becomes a straight segment, which
//     belongs to the coedge after the gap.
//  2. Loops are unwrapped: on a periodic surface, a chain continues beyond the period and is not broken
//     there.
//  3. The face's material lies on the left of every loop in (u, v).
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <string>
#include <vector>

#include "import/bezier_pieces.h"
#include "import/pcurve.h"
#include "import/surface_patches.h"
#include "render/base/result.h"

namespace facetless {

struct LoopSegment {
  std::vector<Vec4> points;  // (w·u, w·v, 0, w)
  double edge_begin = 0, edge_end = 1;
};

struct LoopCoedge {
  TopoDS_Edge edge;        // null: a border that was made for the face
  bool reversed = false;   // the coedge runs against its edge
  bool from_file = false;  // the p-curve comes from the file
  bool degenerate = false;
  std::vector<LoopSegment> segments;
  double gap_mm = 0;
};

struct FaceLoop {
  std::vector<LoopCoedge> coedges;
};

struct FaceLoops {
  std::vector<FaceLoop> loops;
  ParameterBox box;                     // box of all control points
  std::vector<TopoDS_Edge> lost_edges;  // edges for which no p-curve exists or can be computed
  std::vector<std::string> repairs;     // what was repaired in the bounds, one clause each
  std::vector<std::string> joins;       // cuts and closures at poles, which loops around the surface need
  double open_mm = 0;                   // length of the longest line that was invented to close a loop
  std::size_t open_loop = 0;            // index of that loop
  double open_share = 0;                // open_mm divided by the length of that loop
};

// A line that closes a loop is reported if it is longer than this share of the loop.
inline constexpr double kOpenSaid = 1e-3;

// Returns the loops of `face` in its FORWARD orientation. `pcurves_in_file` says that stored p-curves come
// from the file. Errors: kFormatBroken (a wire cannot be closed on its surface, or only with invented lines
// that make up more than half of its length; the loops enclose no area; an edge is far off the surface).
Result<FaceLoops> LoopsOf(const TopoDS_Face& face, bool pcurves_in_file,
                          MissingPcurve missing = MissingPcurve::kByOpenCascade);

}  // namespace facetless
