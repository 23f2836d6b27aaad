// OpenCASCADE's curves as Bézier pieces in their native parameters.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <gp_Trsf.hxx>
#include <vector>

#include "import/bezier_pieces.h"
#include "render/base/result.h"

namespace facetless {

// What the pieces of a hyperbola are: it is rational, but its parameter (that of cosh and sinh) is not.
enum class Parametrization {
  kEndsOnly,  // exact shape; the native parameter agrees at the ends of the pieces
  kNative,    // exact parameter within each piece, by its map; shape approximated where it has to be
};

struct CurvePieces {
  std::vector<CurvePiece> pieces;
  bool approximated = false;
  double deviation = 0;  // measured, in the curve's own units; 0 if not approximated
};

// Pieces over [first, last] of any curve; arcs are at most max_arc radians wide. Parameters may lie beyond
// one period of a periodic curve. Errors: kFormatBroken (range empty or not finite, weight not positive,
// number not finite), kLimitExceeded (more than 4096 periods).
Result<CurvePieces> PiecesOf(const Handle(Geom_Curve) & curve, double first, double last, double max_arc,
                             Parametrization parametrization);
// The same in the plane: points are (w·u, w·v, 0, w).
Result<CurvePieces> PiecesOf(const Handle(Geom2d_Curve) & curve, double first, double last, double max_arc,
                             Parametrization parametrization);

// Removes Geom_TrimmedCurve wrappers: the parameter stays.
Handle(Geom_Curve) Untrimmed(Handle(Geom_Curve) curve);

inline Vec3 ToVec3(const gp_XYZ& p) {
  return {p.X(), p.Y(), p.Z()};
}
// The image of a homogeneous point.
Vec4 Transformed(const gp_Trsf& transformation, Vec4 p);
void Transform(const gp_Trsf& transformation, std::vector<CurvePiece>& pieces);

}  // namespace facetless
