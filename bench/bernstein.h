// Evaluates a tensor-product Bézier patch with any number of components: value and first derivatives, from
// the Bernstein basis.
//
// Both methods in the comparison use this code, so that they differ only in the equations that they solve.
#pragma once

#include <array>

namespace facetless {

inline constexpr int kMaxSceneDegree = 5;

struct BernsteinBasis {
  std::array<double, kMaxSceneDegree + 1> value, slope;

  // Computes the values by de Casteljau's triangle, and the slopes from the values of the next lower degree.
  BernsteinBasis(int degree, double t) {
    value.fill(0);
    slope.fill(0);
    value[0] = 1;
    for (int d = 1; d <= degree; ++d) {
      if (d == degree)
        for (int i = 0; i <= degree; ++i)
          slope[i] = degree * ((i > 0 ? value[i - 1] : 0) - (i < degree ? value[i] : 0));
      for (int i = d; i > 0; --i) value[i] = (1 - t) * value[i] + t * value[i - 1];
      value[0] *= 1 - t;
    }
  }
};

template <int kComponents>
struct PatchJet {
  std::array<double, kComponents> value{}, du{}, dv{};
};

// `points`: (degree_u + 1)·(degree_v + 1) entries, v fastest.
template <int kComponents>
PatchJet<kComponents> EvaluatePatch(const std::array<double, kComponents>* points, int degree_u, int degree_v,
                                    double u, double v) {
  const BernsteinBasis in_u(degree_u, u), in_v(degree_v, v);
  PatchJet<kComponents> jet;
  for (int k = 0; k <= degree_u; ++k) {
    std::array<double, kComponents> row{}, row_slope{};
    for (int l = 0; l <= degree_v; ++l, ++points)
      for (int c = 0; c < kComponents; ++c) {
        row[c] += in_v.value[l] * (*points)[c];
        row_slope[c] += in_v.slope[l] * (*points)[c];
      }
    for (int c = 0; c < kComponents; ++c) {
      jet.value[c] += in_u.value[k] * row[c];
      jet.du[c] += in_u.slope[k] * row[c];
      jet.dv[c] += in_u.value[k] * row_slope[c];
    }
  }
  return jet;
}

}  // namespace facetless
