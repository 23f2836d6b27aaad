#include "samples/generator/bspline.h"

#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <cmath>

namespace facetless::samples {
namespace {

struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;

  Knots(int pole_count, int degree)
      : values(1, pole_count - degree + 1), multiplicities(1, pole_count - degree + 1) {
    const int spans = pole_count - degree;
    for (int i = 0; i <= spans; ++i) {
      values(i + 1) = static_cast<double>(i) / spans;
      multiplicities(i + 1) = i == 0 || i == spans ? degree + 1 : 1;
    }
  }
};

}  // namespace

Handle(Geom_BSplineSurface) ClampedSurface(const TColgp_Array2OfPnt& poles, int degree_u, int degree_v) {
  const Knots u(poles.ColLength(), degree_u), v(poles.RowLength(), degree_v);
  return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities, degree_u,
                                 degree_v);
}

Handle(Geom_BSplineSurface) ClampedSurface(const TColgp_Array2OfPnt& poles,
                                           const TColStd_Array2OfReal& weights, int degree_u, int degree_v) {
  const Knots u(poles.ColLength(), degree_u), v(poles.RowLength(), degree_v);
  return new Geom_BSplineSurface(poles, weights, u.values, v.values, u.multiplicities, v.multiplicities,
                                 degree_u, degree_v);
}

double Rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

}  // namespace facetless::samples
