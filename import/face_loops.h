// A face's loops: its wires as closed chains of Bézier segments in the surface's native parameters.
//
//  1. Chains are closed bit by bit: a gap that the file leaves between two p-curves becomes a straight
//     segment of the coedge that follows.
//  2. Loops are unwrapped: on a periodic surface a chain runs on beyond the period and is never broken at it.
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
  TopoDS_Edge edge;        // null: a border made for the face
  bool reversed = false;   // runs against its edge
  bool from_file = false;  // the p-curve is the file's
  bool degenerate = false;
  std::vector<LoopSegment> segments;
  double gap_mm = 0;
};

struct FaceLoop {
  std::vector<LoopCoedge> coedges;
};

struct FaceLoops {
  std::vector<FaceLoop> loops;
  ParameterBox box;                     // of all control points
  std::vector<TopoDS_Edge> lost_edges;  // no p-curve could be had
  std::vector<std::string> repairs;     // what had to be done to the bounds, one clause each
  std::vector<std::string> joins;       // cuts and poles that loops which go around the surface need
  double open_mm =
      0;  // length of the longest line that was invented to close a loop; open_loop is the index of that loop
  std::size_t open_loop = 0;
  double open_share = 0;  // open_mm as a share of that loop's length
};

// A line that closes a loop is said if it is longer than this share of the loop.
inline constexpr double kOpenSaid = 1e-3;

// The loops of `face` in its FORWARD orientation. `pcurves_in_file`: a stored p-curve is the file's. Errors:
// kFormatBroken (a wire that cannot be closed on its surface, or only by inventing more than half of its
// length; loops that enclose nothing; an edge far off the surface).
Result<FaceLoops> LoopsOf(const TopoDS_Face& face, bool pcurves_in_file,
                          MissingPcurve missing = MissingPcurve::kByOpenCascade);

}  // namespace facetless
