#include "render/nurbs/bezier.h"

#include <cmath>
#include <memory>

namespace facetless {
namespace {

void HalveU(const double* in, int degree_u, int stride, double* low, double* high) {
  const int n = degree_u + 1;
  for (int i = 0; i < n * stride; ++i) high[i] = in[i];
  for (int j = 0; j < stride; ++j) low[j] = high[j];
  for (int level = 1; level < n; ++level) {
    for (int k = 0; k < n - level; ++k) {
      double* row = high + k * stride;
      const double* next = row + stride;
      for (int j = 0; j < stride; ++j) row[j] = 0.5 * (row[j] + next[j]);
    }
    for (int j = 0; j < stride; ++j) low[level * stride + j] = high[j];
  }
}

void HalveV(const double* in, int degree_u, int stride, double* low, double* high) {
  const int n = stride;
  for (int k = 0; k <= degree_u; ++k) {
    double* row = high + k * stride;
    for (int j = 0; j < n; ++j) row[j] = in[k * stride + j];
    low[k * stride] = row[0];
    for (int level = 1; level < n; ++level) {
      for (int j = 0; j < n - level; ++j) row[j] = 0.5 * (row[j] + row[j + 1]);
      low[k * stride + level] = row[0];
    }
  }
}

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

double MaxAbs(const double* values, int count) {
  double largest = 0;
  for (int i = 0; i < count; ++i) {
    const double a = std::fabs(values[i]);
    largest = a <= largest ? largest : a;  // NaN stays
  }
  return largest;
}

void Halve(const BezierNet& net, Direction direction, BezierNet* low, BezierNet* high) {
  // Each of a halving's `degree` averages rounds once, at no more than the net's size.
  const double rounding = 0x1p-53 * (direction == Direction::kU ? net.degree_u : net.degree_v);
  for (int c = 0; c < kNetComponents; ++c) {
    low->error[c] = high->error[c] = net.error[c] + rounding * MaxAbs(net.value[c], net.points());
    if (direction == Direction::kU) {
      HalveU(net.value[c], net.degree_u, net.stride(), low->value[c], high->value[c]);
    } else {
      HalveV(net.value[c], net.degree_u, net.stride(), low->value[c], high->value[c]);
    }
  }
}

void Extend(BezierNet* net, NetComponent c, Direction direction, double low, double high) {
  const bool along_u = direction == Direction::kU;
  const int degree = along_u ? net->degree_u : net->degree_v,
            lines = along_u ? net->stride() : net->degree_u + 1;
  const int step = along_u ? net->stride() : 1, next_line = along_u ? 1 : net->stride();
  // The far end first: over [0, 1 + high] the near end lies at −near.
  const double near = low / (1 + high);
  for (int line = 0; line < lines; ++line) {
    double* p = net->value[c] + line * next_line;
    // Blossoms at 1 + high from the end, then at −near from the beginning.
    for (int i = 1; high > 0 && i <= degree; ++i)
      for (int k = degree; k >= i; --k) p[k * step] += high * (p[k * step] - p[(k - 1) * step]);
    for (int i = 1; near > 0 && i <= degree; ++i)
      for (int k = 0; k <= degree - i; ++k) p[k * step] -= near * (p[(k + 1) * step] - p[k * step]);
  }
  // Each of up to 2·degree steps magnifies what was there by 1 + 2·(low or high), and rounds three times.
  double growth = 1;
  for (int i = 0; i < degree; ++i) growth *= (1 + 2 * high) * (1 + 2 * near);
  net->error[c] =
      growth * net->error[c] + 6 * degree * growth * 0x1p-53 * MaxAbs(net->value[c], net->points());
}

const MonomialMatrix& CenteredMonomialMatrix(int degree) {
  static const auto matrices = [] {
    auto all = std::make_unique<std::array<MonomialMatrix, kMaxDegree + 1>>();
    for (int d = 0; d <= kMaxDegree; ++d) (*all)[d] = MakeMonomialMatrix(d);
    return all;
  }();
  return (*matrices)[degree];
}

void ToCenteredMonomials(const double* in, int degree_u, int degree_v, double* out) {
  const MonomialMatrix& tu = CenteredMonomialMatrix(degree_u);
  const MonomialMatrix& tv = CenteredMonomialMatrix(degree_v);
  const int stride = degree_v + 1;
  double half[kMaxNetPoints];
  for (int k = 0; k <= degree_u; ++k) {
    for (int j = 0; j < stride; ++j) {
      double sum = 0;
      for (int l = 0; l < stride; ++l) sum += tv[j][l] * in[k * stride + l];
      half[k * stride + j] = sum;
    }
  }
  for (int i = 0; i <= degree_u; ++i) {
    double* row = out + i * stride;
    for (int j = 0; j < stride; ++j) row[j] = 0;
    for (int k = 0; k <= degree_u; ++k) {
      const double factor = tu[i][k];
      for (int j = 0; j < stride; ++j) row[j] += factor * half[k * stride + j];
    }
  }
}

}  // namespace facetless
