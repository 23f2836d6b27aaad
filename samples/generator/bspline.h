// Clamped B-spline surfaces over [0, 1]² from their control points: uniform inner knots of multiplicity 1.
#pragma once

#include <Geom_BSplineSurface.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>

namespace facetless::samples {

Handle(Geom_BSplineSurface) ClampedSurface(const TColgp_Array2OfPnt& poles, int degree_u, int degree_v);
Handle(Geom_BSplineSurface) ClampedSurface(const TColgp_Array2OfPnt& poles,
                                           const TColStd_Array2OfReal& weights, int degree_u, int degree_v);

// Rounds `value` to a ten-thousandth of a millimetre, so that the file has the same digits on every machine.
double Rounded(double value);

}  // namespace facetless::samples
