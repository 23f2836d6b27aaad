// The value and the first derivatives of a Bézier patch with any number of components, from the Bernstein basis.
//
//     const PatchJet<3> jet = EvaluatePatch<3>(&scene.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
//     const double x = jet.value[0], w = jet.value[2];
//
// All solvers that evaluate patches use this code, so that they differ only in the equations that they solve.
#pragma once

#include <array>

#include "render/model/model.h"

namespace facetless {

struct BernsteinBasis {
  std::array<double, kMaxDegree + 1> value, slope;

  // Computes the values by de Casteljau's triangle, and the slopes from the values of the next lower degree.
  BernsteinBasis(int degree, double t) {
    value[0] = 1;
    slope[0] = 0;
    for (int d = 1; d <= degree; ++d) {
      if (d == degree) {
        slope[0] = -degree * value[0];
        for (int i = 1; i < degree; ++i) slope[i] = degree * (value[i - 1] - value[i]);
        slope[degree] = degree * value[degree - 1];
      }
      value[d] = t * value[d - 1];
      for (int i = d - 1; i > 0; --i) value[i] = (1 - t) * value[i] + t * value[i - 1];
      value[0] *= 1 - t;
    }
  }
};

template <int kComponents>
struct PatchJet {
  std::array<double, kComponents> value{}, du{}, dv{};
};

// Evaluates the first kComponents of the four numbers of each point. `points`: the first number of
// (degree_u + 1)·(degree_v + 1) points, v fastest. Requires degrees of 1 … kMaxDegree.
template <int kComponents>
PatchJet<kComponents> EvaluatePatch(const double* points, int degree_u, int degree_v, double u, double v) {
  static_assert(kComponents <= 4);
  const BernsteinBasis in_u(degree_u, u), in_v(degree_v, v);
  PatchJet<kComponents> jet;
  for (int k = 0; k <= degree_u; ++k) {
    std::array<double, kComponents> row{}, row_slope{};
    for (int l = 0; l <= degree_v; ++l, points += 4)
      for (int c = 0; c < kComponents; ++c) {
        row[c] += in_v.value[l] * points[c];
        row_slope[c] += in_v.slope[l] * points[c];
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
