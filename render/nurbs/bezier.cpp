#include "render/nurbs/bezier.h"

#include <cmath>
#include <memory>

namespace facetless {
namespace {

MonomialMatrix MakeMonomialMatrix(int degree) {
  MonomialMatrix matrix{};
  double binomial = 1;
  for (int k = 0; k <= degree; ++k) {
    // Expand C(n,k)·2^−n·(1+s)^k·(1−s)^(n−k), one factor at a time.
    std::array<double, kMaxDegree + 1> polynomial{};
    polynomial[0] = binomial;
    for (int factor = 0; factor < degree; ++factor) {
      const double sign = factor < k ? 1 : -1;
      for (int i = factor + 1; i > 0; --i) polynomial[i] += sign * polynomial[i - 1];
    }
    double scale = 1;
    for (int i = 0; i < degree; ++i) scale *= 0.5;
    for (int i = 0; i <= degree; ++i) matrix[i][k] = polynomial[i] * scale;
    binomial = binomial * (degree - k) / (k + 1);
  }
  return matrix;
}

}  // namespace

void Extend(BezierNet* net, NetComponent c, Direction direction, double low, double high) {
  const bool along_u = direction == Direction::kU;
  const int degree = along_u ? net->degree_u : net->degree_v,
            lines = along_u ? net->stride() : net->degree_u + 1;
  const int step = kNetComponents * (along_u ? net->stride() : 1),
            next_line = kNetComponents * (along_u ? 1 : net->stride());
  // Extend the far end first. With respect to [0, 1 + high], the new near end is at −near.
  const double near = low / (1 + high);
  for (int line = 0; line < lines; ++line) {
    double* p = net->value + c + line * next_line;
    // Evaluate blossoms at 1 + high from the end, and then at −near from the beginning.
    for (int i = 1; high > 0 && i <= degree; ++i)
      for (int k = degree; k >= i; --k) p[k * step] += high * (p[k * step] - p[(k - 1) * step]);
    for (int i = 1; near > 0 && i <= degree; ++i)
      for (int k = 0; k <= degree - i; ++k) p[k * step] -= near * (p[(k + 1) * step] - p[k * step]);
  }
  // Each of up to 2·degree steps multiplies existing errors by 1 + 2·(low or high), and rounds three times.
  double growth = 1, largest = 0;
  for (int i = 0; i < degree; ++i) growth *= (1 + 2 * high) * (1 + 2 * near);
  for (int i = 0; i < net->points(); ++i) {
    const double size = std::fabs(net->at(i, c));
    largest = size <= largest ? largest : size;  // NaN stays
  }
  net->error[c] = growth * net->error[c] + 6 * degree * growth * 0x1p-53 * largest;
}

const MonomialMatrix& CenteredMonomialMatrix(int degree) {
  static const auto matrices = [] {
    auto all = std::make_unique<std::array<MonomialMatrix, kMaxDegree + 1>>();
    for (int d = 0; d <= kMaxDegree; ++d) (*all)[d] = MakeMonomialMatrix(d);
    return all;
  }();
  return (*matrices)[degree];
}

}  // namespace facetless
