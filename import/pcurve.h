// Makes the p-curve of one coedge: from the file, from the 3D edge, or improved by projecting the edge. Also
// measures its gap.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <vector>

#include "import/bezier_pieces.h"
#include "render/base/result.h"

namespace facetless {

struct Pcurve {
  std::vector<CurvePiece> pieces;  // along the edge, in the plane z = 0; [begin, end] is in edge parameters
  bool from_file = false;
  double gap_mm = 0;  // largest distance of its points, on the surface, to the 3D edge
};

// Says which code computes a p-curve that the file lacks.
enum class MissingPcurve {
  kProjected,  // ProjectEdge alone. The shape does not change, so that several threads may call it at once
  kByOpenCascade,  // ProjectEdge; if it fails, OpenCASCADE, which stores its p-curve in the shape
};

// Returns the p-curve of `edge` on the FORWARD face. On a seam, the orientation of `edge` selects one of the
// two p-curves. Errors: kFormatBroken (no p-curve is stored, and none can be computed).
Result<Pcurve> MakePcurve(const TopoDS_Edge& edge, const TopoDS_Face& face, bool pcurves_in_file,
                          MissingPcurve missing);

}  // namespace facetless
