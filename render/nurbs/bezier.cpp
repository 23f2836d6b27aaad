#include "render/nurbs/bezier.h"

#include <cmath>
#include <memory>

namespace facetless {
namespace {

template <int P, int Q>
void HalveU(const double* in, int degree_u, int degree_v, double* low, double* high) {
  const int n = (P > 0 ? P : degree_u) + 1, stride = (Q > 0 ? Q : degree_v) + 1;
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

template <int P, int Q>
void HalveV(const double* in, int degree_u, int degree_v, double* low, double* high) {
  const int rows = (P > 0 ? P : degree_u) + 1, n = (Q > 0 ? Q : degree_v) + 1;
  for (int k = 0; k < rows; ++k) {
    double* row = high + k * n;
    for (int j = 0; j < n; ++j) row[j] = in[k * n + j];
    low[k * n] = row[0];
    for (int level = 1; level < n; ++level) {
      for (int j = 0; j < n - level; ++j) row[j] = 0.5 * (row[j] + row[j + 1]);
      low[k * n + level] = row[0];
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
  const int pu = net.degree_u, pv = net.degree_v;
  const double rounding = 0x1p-53 * (direction == Direction::kU ? pu : pv);
  for (int c = 0; c < kNetComponents; ++c)
    low->error[c] = high->error[c] = net.error[c] + rounding * MaxAbs(net.value[c], net.points());
  ByDegrees(pu, pv, [&]<int P, int Q>() {
    for (int c = 0; c < kNetComponents; ++c) {
      if (direction == Direction::kU) {
        HalveU<P, Q>(net.value[c], pu, pv, low->value[c], high->value[c]);
      } else {
        HalveV<P, Q>(net.value[c], pu, pv, low->value[c], high->value[c]);
      }
    }
  });
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

namespace {

// The matrices of all degrees, and their transposes.
struct MonomialMatrices {
  MonomialMatrix plain[kMaxDegree + 1], transposed[kMaxDegree + 1];
};

const MonomialMatrices& AllMonomialMatrices() {
  static const auto matrices = [] {
    auto all = std::make_unique<MonomialMatrices>();
    for (int d = 0; d <= kMaxDegree; ++d) {
      all->plain[d] = MakeMonomialMatrix(d);
      for (int i = 0; i <= d; ++i)
        for (int k = 0; k <= d; ++k) all->transposed[d][k][i] = all->plain[d][i][k];
    }
    return all;
  }();
  return *matrices;
}

}  // namespace

const MonomialMatrix& CenteredMonomialMatrix(int degree) {
  return AllMonomialMatrices().plain[degree];
}

namespace {

const MonomialMatrix& TransposedMonomialMatrix(int degree) {
  return AllMonomialMatrices().transposed[degree];
}

// One line of a net, `step` apart, by the matrix written out: its even and odd rows share sums and differences.
template <int N>
inline void LineToMonomials(const double* in, double* out, int step) {
  if constexpr (N == 1) {
    const double a = in[0], b = in[step];
    out[0] = 0.5 * (a + b);
    out[step] = 0.5 * (b - a);
  } else if constexpr (N == 2) {
    const double ends = in[0] + in[2 * step], middle = 2 * in[step];
    const double difference = in[2 * step] - in[0];
    out[0] = 0.25 * (ends + middle);
    out[step] = 0.5 * difference;
    out[2 * step] = 0.25 * (ends - middle);
  } else {
    static_assert(N == 3);
    const double a = in[0], b = in[step], c = in[2 * step], d = in[3 * step];
    const double ends = a + d, middle = b + c, outer = d - a, inner = c - b;
    out[0] = 0.125 * (ends + 3 * middle);
    out[step] = 0.375 * (outer + inner);
    out[2 * step] = 0.375 * (ends - middle);
    out[3 * step] = 0.125 * (outer - 3 * inner);
  }
}

void MultiplyByMatrices(const double* in, int degree_u, int degree_v, double* out) {
  const MonomialMatrix& tu = CenteredMonomialMatrix(degree_u);
  const MonomialMatrix& tv = TransposedMonomialMatrix(degree_v);
  const int stride = degree_v + 1;
  double half[kMaxNetPoints];
  for (int k = 0; k <= degree_u; ++k) {
    double* row = half + k * stride;
    for (int j = 0; j < stride; ++j) row[j] = 0;
    for (int l = 0; l < stride; ++l) {
      const double factor = in[k * stride + l];
      for (int j = 0; j < stride; ++j) row[j] += tv[l][j] * factor;
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

}  // namespace

void ToCenteredMonomials(const double* in, int degree_u, int degree_v, double* out) {
  ByDegrees(degree_u, degree_v, [&]<int P, int Q>() {
    if constexpr (P < 0) {
      MultiplyByMatrices(in, degree_u, degree_v, out);
    } else {
      double half[(P + 1) * (Q + 1)];
      for (int j = 0; j <= Q; ++j) LineToMonomials<P>(in + j, half + j, Q + 1);
      for (int i = 0; i <= P; ++i) LineToMonomials<Q>(half + i * (Q + 1), out + i * (Q + 1), 1);
    }
  });
}

}  // namespace facetless
