// Bézier nets: halving and centred monomials.
#include "render/nurbs/bezier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace facetless {
namespace {

double Bernstein(const double* b, int degree, double t) {
  std::vector<double> p(b, b + degree + 1);
  for (int n = degree; n > 0; --n) {
    for (int i = 0; i < n; ++i) p[i] += t * (p[i + 1] - p[i]);
  }
  return p[0];
}

TEST(Bezier, MonomialMatrixReproducesTheBernsteinBasisForEveryDegree) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    const MonomialMatrix& matrix = CenteredMonomialMatrix(degree);
    for (int k = 0; k <= degree; ++k) {
      std::vector<double> basis(degree + 1, 0.0);
      basis[k] = 1;
      for (const double s : {-1.0, -0.5, 0.0, 0.25, 1.0}) {
        double value = 0;
        for (int i = degree; i >= 0; --i) value = value * s + matrix[i][k];
        // The monomial form of degree 25 cancels ten digits; of the degrees that CAD has, three.
        EXPECT_NEAR(value, Bernstein(basis.data(), degree, 0.5 * (1 + s)), 1e-16 * std::pow(2.5, degree))
            << degree << " " << k;
      }
    }
  }
}

TEST(Bezier, HalvesShareTheirBorderBitByBitAndAgreeWithTheWhole) {
  const int pu = 4, pv = 3;
  std::vector<double> whole(kNetComponents * (pu + 1) * (pv + 1)), low_storage(whole.size()),
      high_storage(whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) whole[i] = std::sin(1.7 * double(i) + 0.3);
  BezierNet net, low, high;
  for (BezierNet* each : {&net, &low, &high}) {
    each->degree_u = pu;
    each->degree_v = pv;
    double* storage = each == &net ? whole.data() : each == &low ? low_storage.data() : high_storage.data();
    for (int c = 0; c < kNetComponents; ++c) each->value[c] = storage + c * each->points();
  }
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    Halve(net, direction, &low, &high);
    for (int c = 0; c < kNetComponents; ++c) {
      const int last = direction == Direction::kU ? pu : pv, other = direction == Direction::kU ? pv : pu;
      for (int k = 0; k <= other; ++k) {
        const int i = direction == Direction::kU ? last * net.stride() + k : k * net.stride() + last;
        const int j = direction == Direction::kU ? k : k * net.stride();
        EXPECT_EQ(low.value[c][i], high.value[c][j]);
      }
      // One point of each half against the whole, through monomials on both sides.
      std::vector<double> m(net.points()), ml(net.points()), mh(net.points());
      ToCenteredMonomials(net.value[c], pu, pv, m.data());
      ToCenteredMonomials(low.value[c], pu, pv, ml.data());
      ToCenteredMonomials(high.value[c], pu, pv, mh.data());
      const auto value = [&](const std::vector<double>& q, double s, double t) {
        double f = 0;
        for (int i = pu; i >= 0; --i) {
          double row = 0;
          for (int j = pv; j >= 0; --j) row = row * t + q[i * net.stride() + j];
          f = f * s + row;
        }
        return f;
      };
      const double s = 0.3, t = -0.7;
      if (direction == Direction::kU) {
        EXPECT_NEAR(value(ml, s, t), value(m, (s - 1) / 2, t), 1e-14);
        EXPECT_NEAR(value(mh, s, t), value(m, (s + 1) / 2, t), 1e-14);
      } else {
        EXPECT_NEAR(value(ml, s, t), value(m, s, (t - 1) / 2), 1e-14);
        EXPECT_NEAR(value(mh, s, t), value(m, s, (t + 1) / 2), 1e-14);
      }
    }
  }
}

TEST(Bezier, AnExtendedNetIsTheSamePolynomialOverALongerInterval) {
  const int pu = 3, pv = 2;
  const double low = 0.11, high = 0.07;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    BezierNet net;
    net.degree_u = pu, net.degree_v = pv;
    std::vector<double> before(net.points()), after;
    for (std::size_t i = 0; i < before.size(); ++i) before[i] = std::sin(2.3 * double(i) + 0.1);
    after = before;
    net.value[kX] = after.data();
    Extend(&net, kX, direction, low, high);
    const bool along_u = direction == Direction::kU;
    const int degree = along_u ? pu : pv, lines = along_u ? pv + 1 : pu + 1;
    for (int line = 0; line < lines; ++line) {
      std::vector<double> b(degree + 1), e(degree + 1);
      for (int k = 0; k <= degree; ++k) {
        const int i = along_u ? k * net.stride() + line : line * net.stride() + k;
        b[k] = before[i], e[k] = after[i];
      }
      for (const double t : {0.0, 0.25, 0.5, 1.0})
        EXPECT_NEAR(Bernstein(e.data(), degree, t), Bernstein(b.data(), degree, -low + t * (1 + low + high)),
                    1e-14);
    }
  }
}

TEST(Bezier, ExtendingOneEndLeavesTheOtherAsItIs) {
  BezierNet net;
  net.degree_u = net.degree_v = 3;
  std::vector<double> before(net.points());
  for (std::size_t i = 0; i < before.size(); ++i) before[i] = std::cos(1.9 * double(i));
  for (const bool high : {false, true}) {
    std::vector<double> after = before;
    net.value[kX] = after.data();
    Extend(&net, kX, Direction::kU, high ? 0 : 0.1, high ? 0.1 : 0);
    for (int l = 0; l <= 3; ++l) {
      const int still = high ? l : 3 * net.stride() + l, moved = high ? 3 * net.stride() + l : l;
      EXPECT_EQ(after[still], before[still]);
      EXPECT_NE(after[moved], before[moved]);
    }
  }
}

}  // namespace
}  // namespace facetless
