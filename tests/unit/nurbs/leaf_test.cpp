// Leaf certificates: their guarantees, tested on random patches and rays.
#include "render/nurbs/leaf.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "render/kernels/net_kernel.h"
#include "render/kernels/tile_kernel.h"

namespace facetless {
namespace {

// A bumpy sheet of about `size` pixels, with weights between 1 and 1 + spread.
OwnedNet RandomSheet(unsigned seed, int degree_u, int degree_v, double bump, double spread) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  OwnedNet sheet;
  sheet.SetDegrees(degree_u, degree_v);
  const double size = 20, skew = unit(random);
  for (int k = 0; k <= degree_u; ++k) {
    for (int l = 0; l <= degree_v; ++l) {
      const int i = k * (degree_v + 1) + l;
      const double w = spread > 0 ? 1 + spread * (0.5 + 0.5 * unit(random)) : 1;
      const double u = double(k) / degree_u, v = double(l) / degree_v;
      sheet.net.at(i, kX) = w * (100 + size * (u + skew * v + bump * unit(random)));
      sheet.net.at(i, kY) = w * (-50 + size * (v + bump * unit(random)));
      sheet.net.at(i, kW) = w;
      sheet.net.at(i, kQ) = w * (5 + unit(random));
    }
  }
  return sheet;
}

// The projected point of a net at (u, v), by de Casteljau in long double.
struct Point {
  long double x, y, w, q;
};
Point Evaluate(const BezierNet& net, long double u, long double v) {
  long double result[kNetComponents];
  for (int c = 0; c < kNetComponents; ++c) {
    std::vector<long double> row(net.degree_u + 1);
    for (int k = 0; k <= net.degree_u; ++k) {
      std::vector<long double> p(net.stride());
      for (int l = 0; l < net.stride(); ++l) p[l] = net.at(k * net.stride() + l, NetComponent(c));
      for (int n = net.degree_v; n > 0; --n) {
        for (int l = 0; l < n; ++l) p[l] += v * (p[l + 1] - p[l]);
      }
      row[k] = p[0];
    }
    for (int n = net.degree_u; n > 0; --n) {
      for (int k = 0; k < n; ++k) row[k] += u * (row[k + 1] - row[k]);
    }
    result[c] = row[0];
  }
  return {result[0], result[1], result[2], result[3]};
}

RC_GTEST_PROP(Leaf, ARayThroughASurfacePointFindsThatPointAndNoOther, ()) {
  const int degree_u = *rc::gen::inRange(1, kMaxDegree + 1), degree_v = *rc::gen::inRange(1, kMaxDegree + 1);
  const double spread = *rc::gen::element(0.0, 0.02);
  // The slope of the bumps grows with the degree.
  const double bump = 0.03 / std::max({degree_u, degree_v, 3});
  const OwnedNet sheet = RandomSheet(*rc::gen::arbitrary<unsigned>(), degree_u, degree_v, bump,
                                     spread / std::max({degree_u, degree_v, 1}));
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  const DepthRule rule{false, spread > 0, true};
  if (!kernel_scalar::kNets.certify(sheet.net, rule, kDoubleArithmetic, &leaf, monomials).certified)
    RC_DISCARD("not certified");
  leaf.coefficients = monomials;
  RC_ASSERT(1 - 1 / leaf.inverse_gap <= kMaxKappa);
  const double u = *rc::gen::inRange(0, 1001) / 1000.0, v = *rc::gen::inRange(0, 1001) / 1000.0;
  const Point p = Evaluate(sheet.net, u, v);
  TileHit hit{};
  RC_ASSERT(kernel_scalar::SolveSample(leaf, kDoubleArithmetic, double(p.x / p.w), double(p.y / p.w), &hit) ==
            SampleRoot::kHit);
  // The pixel position itself is rounded: half a unit of 128, relative to the leaf's size of about ten
  // pixels.
  RC_ASSERT(std::fabs(hit.s - (2 * u - 1)) < 1e-11);
  RC_ASSERT(std::fabs(hit.t - (2 * v - 1)) < 1e-11);
  RC_ASSERT(std::fabs(hit.depth - double(p.q / p.w)) < 1e-11);
}

RC_GTEST_PROP(Leaf, ARayBesideTheLeafIsAProvenMiss, ()) {
  const OwnedNet sheet = RandomSheet(*rc::gen::arbitrary<unsigned>(), 3, 3, 0.01, 0.02);
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  if (!kernel_scalar::kNets.certify(sheet.net, {false, true, true}, kDoubleArithmetic, &leaf, monomials)
           .certified)
    RC_DISCARD("not certified");
  leaf.coefficients = monomials;
  // A point of the surface's continuation beyond the leaf's border, outside it by at least 1e-6 of its size.
  const double outside = *rc::gen::element(1e-6, 1e-4, 1e-2, 0.03);
  const double along = *rc::gen::inRange(0, 1001) / 1000.0;
  const Point p = Evaluate(sheet.net, 1 + outside, along);
  TileHit hit{};
  RC_ASSERT(kernel_scalar::SolveSample(leaf, kDoubleArithmetic, double(p.x / p.w), double(p.y / p.w), &hit) ==
            SampleRoot::kMiss);
}

TEST(Leaf, AFoldHasNoCertificate) {
  OwnedNet fold;
  fold.SetDegrees(2, 1);
  const double x[] = {0, 0, 10, 10, 0, 0}, y[] = {0, 10, 0, 10, 0, 10};
  for (int i = 0; i < 6; ++i) {
    fold.net.at(i, kX) = x[i];
    fold.net.at(i, kY) = y[i];
    fold.net.at(i, kW) = 1;
    fold.net.at(i, kQ) = i;
  }
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  const NetVerdict verdict =
      kernel_scalar::kNets.certify(fold.net, {false, false, true}, kDoubleArithmetic, &leaf, monomials);
  EXPECT_FALSE(verdict.certified);
}

TEST(Leaf, HalvingIsPromisedToHelpInTheDirectionThatBends) {
  OwnedNet bent;
  bent.SetDegrees(2, 1);
  const double x[] = {0, 0, 8, 8, 10, 10}, y[] = {0, 10, 0, 10, 0, 10};
  for (int i = 0; i < 6; ++i) {
    bent.net.at(i, kX) = x[i];
    bent.net.at(i, kY) = y[i];
    bent.net.at(i, kW) = 1;
    bent.net.at(i, kQ) = 0;
  }
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  const NetVerdict verdict =
      kernel_scalar::kNets.certify(bent.net, {false, false, false}, kDoubleArithmetic, &leaf, monomials);
  ASSERT_FALSE(verdict.certified);
  EXPECT_LT(verdict.kappa_halved_u, verdict.kappa_halved_v);
}

// The step W/M·(M_U, M_V) of A. Sisojevs with the determinants of eq. 12 and 13, as an oracle for the
// homogeneous form.
struct ThesisStep {
  long double du, dv;
};
ThesisStep Thesis(const BezierNet& net, long double u, long double v, long double x_r, long double y_r) {
  const long double h = 1e-6L;
  const Point s = Evaluate(net, u, v), a = Evaluate(net, u + h, v), b = Evaluate(net, u - h, v),
              c = Evaluate(net, u, v + h), d = Evaluate(net, u, v - h);
  const Point su{(a.x - b.x) / (2 * h), (a.y - b.y) / (2 * h), (a.w - b.w) / (2 * h), 0};
  const Point sv{(c.x - d.x) / (2 * h), (c.y - d.y) / (2 * h), (c.w - d.w) / (2 * h), 0};
  const Point r{x_r, y_r, 1, 0};
  const auto det = [](const Point& p, const Point& q, const Point& t) {
    return p.x * (q.y * t.w - q.w * t.y) - q.x * (p.y * t.w - p.w * t.y) + t.x * (p.y * q.w - p.w * q.y);
  };
  const long double factor = s.w / det(s, su, sv);
  return {factor * det(s, r, sv), factor * det(s, su, r)};
}

RC_GTEST_PROP(Leaf, TheThesisIterationConvergesToTheSameRoot, ()) {
  const OwnedNet sheet = RandomSheet(*rc::gen::arbitrary<unsigned>(), 3, 3, 0.01, 0.02);
  CertifiedLeaf leaf;
  double monomials[kNetComponents * kMaxNetPoints];
  if (!kernel_scalar::kNets.certify(sheet.net, {false, true, true}, kDoubleArithmetic, &leaf, monomials)
           .certified)
    RC_DISCARD("not certified");
  leaf.coefficients = monomials;
  const Point p = Evaluate(sheet.net, 0.3L, 0.8L);
  const long double x = double(p.x / p.w), y = double(p.y / p.w);
  TileHit hit{};
  RC_ASSERT(kernel_scalar::SolveSample(leaf, kDoubleArithmetic, double(x), double(y), &hit) ==
            SampleRoot::kHit);
  long double u = 0.5L, v = 0.5L;
  for (int i = 0; i < 40; ++i) {
    const ThesisStep step = Thesis(sheet.net, u, v, x, y);
    u += step.du;
    v += step.dv;
  }
  RC_ASSERT(std::fabs(double(2 * u - 1) - hit.s) < 1e-10);
  RC_ASSERT(std::fabs(double(2 * v - 1) - hit.t) < 1e-10);
}

}  // namespace
}  // namespace facetless
