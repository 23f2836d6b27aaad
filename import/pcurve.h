// One coedge's p-curve: from the file, from the 3D edge, or improved by projecting the edge, with its
// measured gap.
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

// Who computes a p-curve that the file lacks.
enum class MissingPcurve {
  kProjected,      // ProjectEdge alone; the shape stays as it is, so that calls may run side by side
  kByOpenCascade,  // ProjectEdge, and OpenCASCADE where that fails, which stores its own with the shape
};

// The p-curve of `edge` (its orientation chooses among the two of a seam) on the FORWARD face.
// Errors: kFormatBroken (none stored, and none can be computed).
Result<Pcurve> MakePcurve(const TopoDS_Edge& edge, const TopoDS_Face& face, bool pcurves_in_file,
                          MissingPcurve missing);

}  // namespace facetless
