// Operations on nets: halving and residuals are compared with their definitions, and all builds give the same
// bits.
#include "render/kernels/net_kernel.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "render/kernels/dispatch.h"

namespace facetless {
namespace {

// A sheet of about 20 pixels. The coefficients deviate randomly by `bump` of that.
OwnedNet RandomNet(unsigned seed, int degree_u, int degree_v, double bump, bool rational) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  OwnedNet owned;
  owned.SetDegrees(degree_u, degree_v);
  BezierNet& net = owned.net;
  for (int k = 0; k <= degree_u; ++k) {
    for (int l = 0; l <= degree_v; ++l) {
      const int i = k * net.stride() + l;
      const double w = rational ? 1.1 + 0.1 * unit(random) : 1;
      net.at(i, kX) = w * (100 + 20 * (double(k) / degree_u + bump * unit(random)));
      net.at(i, kY) = w * (-50 + 20 * (double(l) / degree_v + bump * unit(random)));
      net.at(i, kW) = w;
      net.at(i, kQ) = w * (5 + unit(random));
    }
  }
  for (double& error : net.error) error = 1e-15 * (1 + unit(random));
  return owned;
}

// Evaluates by de Casteljau's algorithm.
double Evaluate(const BezierNet& net, NetComponent c, double u, double v) {
  std::vector<double> row(net.degree_u + 1);
  for (int k = 0; k <= net.degree_u; ++k) {
    std::vector<double> p(net.stride());
    for (int l = 0; l < net.stride(); ++l) p[l] = net.at(k * net.stride() + l, c);
    for (int n = net.degree_v; n > 0; --n)
      for (int l = 0; l < n; ++l) p[l] += v * (p[l + 1] - p[l]);
    row[k] = p[0];
  }
  for (int n = net.degree_u; n > 0; --n)
    for (int k = 0; k < n; ++k) row[k] += u * (row[k + 1] - row[k]);
  return row[0];
}

std::vector<NetOperations> AllBuilds() {
  std::vector<NetOperations> builds;
  for (const Kernels& kernels : AvailableKernels()) builds.push_back(*kernels.nets);
  return builds;
}

template <typename T>
bool SameBits(const T* a, const T* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(T)) == 0;
}

TEST(NetKernel, HalvesShareTheirBorderBitByBitAndAgreeWithTheWhole) {
  for (int pair = 0; pair < kMaxDegree * kMaxDegree; ++pair) {
    const int pu = 1 + pair / kMaxDegree, pv = 1 + pair % kMaxDegree;
    SCOPED_TRACE(std::to_string(pu) + "×" + std::to_string(pv));
    const OwnedNet whole = RandomNet(static_cast<unsigned>(3 + pair), pu, pv, 0.5, true);
    OwnedNet low, high;
    low.SetDegrees(pu, pv);
    high.SetDegrees(pu, pv);
    for (const NetOperations& nets : AllBuilds()) {
      for (const Direction direction : {Direction::kU, Direction::kV}) {
        nets.halve(whole.net, direction, &low.net, &high.net);
        const bool along_u = direction == Direction::kU;
        const int stride = whole.net.stride();
        for (const NetComponent c : {kX, kY, kW, kQ}) {
          for (int k = 0; k <= (along_u ? pv : pu); ++k) {
            const int i = along_u ? pu * stride + k : k * stride + pv, j = along_u ? k : k * stride;
            EXPECT_EQ(low.net.at(i, c), high.net.at(j, c));
          }
          const double u = 0.65, v = 0.15;
          EXPECT_NEAR(Evaluate(low.net, c, u, v),
                      along_u ? Evaluate(whole.net, c, u / 2, v) : Evaluate(whole.net, c, u, v / 2), 1e-13);
          EXPECT_NEAR(
              Evaluate(high.net, c, u, v),
              along_u ? Evaluate(whole.net, c, (1 + u) / 2, v) : Evaluate(whole.net, c, u, (1 + v) / 2),
              1e-13);
          EXPECT_GT(low.net.error[c], whole.net.error[c]);
          EXPECT_LT(low.net.error[c], whole.net.error[c] + 2e-14 * std::max(pu, pv));
        }
      }
    }
  }
}

RC_GTEST_PROP(NetKernel, ARayThroughAPointOfTheNetIsNeverProvenAway, ()) {
  const OwnedNet owned = RandomNet(*rc::gen::arbitrary<unsigned>(), *rc::gen::inRange(1, kMaxDegree + 1),
                                   *rc::gen::inRange(1, kMaxDegree + 1),
                                   *rc::gen::element(0.0, 0.01, 0.3, 2.0), *rc::gen::arbitrary<bool>());
  const double u = *rc::gen::inRange(0, 101) / 100.0, v = *rc::gen::inRange(0, 101) / 100.0;
  BezierNet net = owned.net;
  // The tolerance covers the rounding of the point.
  for (double& error : net.error) error += 1e-13;
  const double w = Evaluate(net, kW, u, v);
  RC_ASSERT(
      !kernel_scalar::kNets.residual(net, Evaluate(net, kX, u, v) / w, Evaluate(net, kY, u, v) / w).empty);
}

TEST(NetKernel, ARayBesideASlantingFoldIsProvenAwayAlthoughItLiesInTheBox) {
  // x = u, y = u + 0.02·v²: a strip along the diagonal, folded at v = 0.
  OwnedNet owned;
  owned.SetDegrees(1, 2);
  const double y[] = {0.02, -0.02, 0.02};
  for (int k = 0; k <= 1; ++k) {
    for (int l = 0; l <= 2; ++l) {
      owned.net.at(3 * k + l, kX) = k;
      owned.net.at(3 * k + l, kY) = k + y[l];
      owned.net.at(3 * k + l, kW) = 1;
      owned.net.at(3 * k + l, kQ) = l;
    }
  }
  for (const NetOperations& nets : AllBuilds()) {
    EXPECT_TRUE(nets.residual(owned.net, 0.5, 0.6).empty);
    EXPECT_TRUE(nets.residual(owned.net, 0.5, 0.4).empty);
    EXPECT_FALSE(nets.residual(owned.net, 0.5, 0.51).empty);
    EXPECT_TRUE(nets.residual(owned.net, 1.5, 1.5).empty);
  }
}

RC_GTEST_PROP(NetKernel, EveryBuildGivesTheSameBits, ()) {
  const int pu = *rc::gen::inRange(1, kMaxDegree + 1), pv = *rc::gen::inRange(1, kMaxDegree + 1);
  const bool rational = *rc::gen::arbitrary<bool>(), perspective = *rc::gen::arbitrary<bool>();
  const double bump = *rc::gen::element(0.0, 0.01, 0.05, 0.5);
  const OwnedNet owned = RandomNet(*rc::gen::arbitrary<unsigned>(), pu, pv, bump, rational);
  const BezierNet& net = owned.net;
  const std::size_t n = kNetComponents * net.points();
  const DepthRule rule{perspective, rational, true};
  const std::vector<NetOperations> builds = AllBuilds();
  const NetOperations& oracle = builds.front();
  for (const NetOperations& nets : builds) {
    OwnedNet halves[4];
    for (OwnedNet& half : halves) half.SetDegrees(pu, pv);
    const Direction direction = *rc::gen::element(Direction::kU, Direction::kV);
    oracle.halve(net, direction, &halves[0].net, &halves[1].net);
    nets.halve(net, direction, &halves[2].net, &halves[3].net);
    for (int i = 0; i < 2; ++i) {
      RC_ASSERT(SameBits(halves[i].net.value, halves[i + 2].net.value, n));
      RC_ASSERT(SameBits(halves[i].net.error, halves[i + 2].net.error, kNetComponents));
    }

    CertifiedLeaf expected, leaf;
    std::vector<double> expected_monomials(n), monomials(n);
    const NetVerdict first =
        oracle.certify(net, rule, kDoubleArithmetic, &expected, expected_monomials.data());
    const NetVerdict second = nets.certify(net, rule, kDoubleArithmetic, &leaf, monomials.data());
    RC_ASSERT(first.certified == second.certified);
    RC_ASSERT(SameBits(&first.kappa_halved_u, &second.kappa_halved_u, 1));
    RC_ASSERT(SameBits(&first.kappa_halved_v, &second.kappa_halved_v, 1));
    RC_ASSERT(SameBits(expected_monomials.data(), monomials.data(), n));
    for (const auto member :
         {&CertifiedLeaf::center_x, &CertifiedLeaf::center_y, &CertifiedLeaf::c11, &CertifiedLeaf::c22,
          &CertifiedLeaf::b_limit, &CertifiedLeaf::newton_factor, &CertifiedLeaf::rounding,
          &CertifiedLeaf::depth_scale, &CertifiedLeaf::depth_error})
      RC_ASSERT(SameBits(&(expected.*member), &(leaf.*member), 1));
    RC_TAG(first.certified ? "certified" : "not certified");

    const NetBox box = oracle.project(net, rule, 512), other_box = nets.project(net, rule, 512);
    RC_ASSERT(SameBits(&box.x_low, &other_box.x_low, 7));
    for (const bool in_front : {false, true}) {
      const Extent extent = oracle.measure(net, rule, 512, in_front),
                   other = nets.measure(net, rule, 512, in_front);
      RC_ASSERT(SameBits(&extent.u, &other.u, 2));
    }
    const Residual residual = oracle.residual(net, 101, -47), other = nets.residual(net, 101, -47);
    RC_ASSERT(residual.empty == other.empty);
    RC_ASSERT(SameBits(&residual.size, &other.size, 5));
  }
}

}  // namespace
}  // namespace facetless
