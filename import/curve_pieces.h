// Converts OpenCASCADE's curves to Bézier pieces in their native parameters.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <gp_Trsf.hxx>
#include <vector>

#include "import/bezier_pieces.h"
#include "render/base/result.h"

namespace facetless {

// Says what the pieces of a hyperbola preserve. Its shape is rational, but its parameter (that of cosh and
// sinh) is not.
enum class Parametrization {
  kEndsOnly,  // exact shape; the native parameter is exact only at the ends of the pieces
  kNative,    // exact parameter within each piece, by its map; the shape is approximated where necessary
};

struct CurvePieces {
  std::vector<CurvePiece> pieces;
  bool approximated = false;
  double deviation = 0;  // measured, in the curve's own units; 0 if not approximated
};

// Returns the pieces over [first, last] of any curve. Arcs are at most max_arc radians wide. The range may
// extend beyond one period of a periodic curve. Errors: kFormatBroken (the range is empty or not finite, a
// weight is not positive, a number is not finite), kLimitExceeded (the range covers more than 4096 periods).
Result<CurvePieces> PiecesOf(const Handle(Geom_Curve) & curve, double first, double last, double max_arc,
                             Parametrization parametrization);
// The same for a plane curve. The points are (w·u, w·v, 0, w).
Result<CurvePieces> PiecesOf(const Handle(Geom2d_Curve) & curve, double first, double last, double max_arc,
                             Parametrization parametrization);

// Removes Geom_TrimmedCurve wrappers. The parameter does not change.
Handle(Geom_Curve) Untrimmed(Handle(Geom_Curve) curve);

inline Vec3 ToVec3(const gp_XYZ& p) {
  return {p.X(), p.Y(), p.Z()};
}
// Applies the transformation to a homogeneous point.
Vec4 Transformed(const gp_Trsf& transformation, Vec4 p);
void Transform(const gp_Trsf& transformation, std::vector<CurvePiece>& pieces);

}  // namespace facetless
