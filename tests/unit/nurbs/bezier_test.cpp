// Bézier nets: extending, and the matrices of centred monomials.
#include "render/nurbs/bezier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
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

// A packed key of both degrees was once ambiguous: degrees 1×9 ran with the loops for 2×1.
TEST(Bezier, EveryPairOfDegreesRunsWithItsOwnLoopsOrWithThoseOfAnyDegree) {
  for (int degree_u = 0; degree_u <= kMaxDegree + 1; ++degree_u) {
    for (int degree_v = 0; degree_v <= kMaxDegree + 1; ++degree_v) {
      const auto [fixed_u, fixed_v] =
          ByDegrees(degree_u, degree_v, []<int P, int Q>() { return std::pair(P, Q); });
      const auto is_fixed = [](int degree) { return degree >= 1 && degree <= kMaxFixedDegree; };
      const bool fixed = is_fixed(degree_u) && is_fixed(degree_v);
      const bool inner_fixed = degree_v >= 1 && degree_v <= kMaxFixedInnerDegree;
      EXPECT_EQ(fixed_u, fixed ? degree_u : -1) << degree_u << "×" << degree_v;
      EXPECT_EQ(fixed_v, inner_fixed ? degree_v : -1) << degree_u << "×" << degree_v;
    }
  }
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
        // The monomial form of degree 25 loses ten digits by cancellation; for degrees that occur in CAD, it
        // loses three.
        EXPECT_NEAR(value, Bernstein(basis.data(), degree, 0.5 * (1 + s)), 1e-16 * std::pow(2.5, degree))
            << degree << " " << k;
      }
    }
  }
}

TEST(Bezier, AnExtendedNetIsTheSamePolynomialOverALongerInterval) {
  const int pu = 3, pv = 2;
  const double low = 0.11, high = 0.07;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    OwnedNet owned;
    owned.SetDegrees(pu, pv);
    BezierNet& net = owned.net;
    std::vector<double> before(net.points()), after(net.points());
    for (int i = 0; i < net.points(); ++i) net.at(i, kX) = before[i] = std::sin(2.3 * i + 0.1);
    Extend(&net, kX, direction, low, high);
    for (int i = 0; i < net.points(); ++i) after[i] = net.at(i, kX);
    const bool along_u = direction == Direction::kU;
    const int degree = along_u ? pu : pv, lines = along_u ? pv + 1 : pu + 1;
    for (int line = 0; line < lines; ++line) {
      std::vector<double> b(degree + 1), e(degree + 1);
      for (int k = 0; k <= degree; ++k) {
        const int i = along_u ? k * net.stride() + line : line * net.stride() + k;
        b[k] = before[i];
        e[k] = after[i];
      }
      for (const double t : {0.0, 0.25, 0.5, 1.0})
        EXPECT_NEAR(Bernstein(e.data(), degree, t), Bernstein(b.data(), degree, -low + t * (1 + low + high)),
                    1e-14);
    }
  }
}

TEST(Bezier, ExtendingOneEndLeavesTheOtherAsItIs) {
  OwnedNet owned;
  owned.SetDegrees(3, 3);
  BezierNet& net = owned.net;
  std::vector<double> before(net.points()), after(net.points());
  for (int i = 0; i < net.points(); ++i) before[i] = std::cos(1.9 * i);
  for (const bool high : {false, true}) {
    for (int i = 0; i < net.points(); ++i) net.at(i, kX) = before[i];
    Extend(&net, kX, Direction::kU, high ? 0 : 0.1, high ? 0.1 : 0);
    for (int i = 0; i < net.points(); ++i) after[i] = net.at(i, kX);
    for (int l = 0; l <= 3; ++l) {
      const int still = high ? l : 3 * net.stride() + l, moved = high ? 3 * net.stride() + l : l;
      EXPECT_EQ(after[still], before[still]);
      EXPECT_NE(after[moved], before[moved]);
    }
  }
}

}  // namespace
}  // namespace facetless
