#include <BRepBuilderAPI_MakeFace.hxx>
#include <Precision.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>

#include "samples/generator/bspline.h"
#include "samples/generator/shapes.h"

namespace facetless::samples {

TopoDS_Shape WavySheet() {
  constexpr int kSpans = 37, kDegree = 3, kPoles = kSpans + kDegree;
  constexpr double kSize = 100;

  // Control points above the Greville abscissae, so that x and y are linear in the parameters.
  const auto greville = [&](int i) {
    double sum = 0;
    for (int k = 1; k <= kDegree; ++k) sum += std::clamp(i + k - kDegree, 0, kSpans);
    return sum / kDegree;
  };
  const auto height = [](double s, double t) {
    return 4 * std::sin(0.83 * s) * std::cos(0.61 * t) + 2.5 * std::sin(0.29 * s + 0.47 * t);
  };
  TColgp_Array2OfPnt poles(1, kPoles, 1, kPoles);
  for (int i = 0; i < kPoles; ++i) {
    for (int j = 0; j < kPoles; ++j) {
      const double s = greville(i), t = greville(j);
      poles(i + 1, j + 1) = gp_Pnt(kSize * s / kSpans, kSize * t / kSpans, Rounded(height(s, t)));
    }
  }
  return BRepBuilderAPI_MakeFace(ClampedSurface(poles, kDegree, kDegree), Precision::Confusion()).Face();
}

}  // namespace facetless::samples
