#include "render/trace/fallback_solver.h"

#include <algorithm>
#include <cmath>

namespace facetless {
namespace {

// Halving a net n times rounds n times; 128 units cover the deepest chain and the forming of F.
constexpr double kRounding = 128 * 0x1p-53;

}  // namespace

struct FallbackSolver::Piece {
  BezierNet net;
  std::vector<double> storage;
  double s_mid = 0, s_half = 1, t_mid = 0, t_half = 1;

  void Set(int degree_u, int degree_v) {
    net.degree_u = degree_u;
    net.degree_v = degree_v;
    const std::size_t n = net.points();
    if (storage.size() < kNetComponents * n) storage.resize(kNetComponents * n);
    for (int c = 0; c < kNetComponents; ++c) net.value[c] = storage.data() + c * n;
  }
};

FallbackSolver::FallbackSolver() = default;
FallbackSolver::~FallbackSolver() = default;

namespace {

// The range of F = X − x·W and Y − y·W over a piece.
struct Residual {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, magnitude[2] = {0, 0};
  double extent_u = 0, extent_v = 0;

  bool Empty() const {
    for (int c = 0; c < 2; ++c) {
      const double slack = kRounding * magnitude[c];
      if (low[c] > slack || high[c] < -slack) return true;
    }
    return false;
  }
  double size() const { return std::max(high[0] - low[0], high[1] - low[1]); }
};

Residual Measure(const BezierNet& net, double x, double y) {
  Residual residual;
  const int stride = net.stride();
  double f[kMaxNetPoints];
  for (int c = 0; c < 2; ++c) {
    const double* value = net.value[c == 0 ? kX : kY];
    const double pixel = c == 0 ? x : y;
    for (int i = 0; i < net.points(); ++i) {
      f[i] = value[i] - pixel * net.value[kW][i];
      residual.low[c] = std::min(residual.low[c], f[i]);
      residual.high[c] = std::max(residual.high[c], f[i]);
      residual.magnitude[c] =
          std::max(residual.magnitude[c], std::fabs(value[i]) + std::fabs(pixel * net.value[kW][i]));
    }
    for (int k = 0; k <= net.degree_u; ++k) {
      for (int l = 0; l <= net.degree_v; ++l) {
        const int i = k * stride + l;
        if (k < net.degree_u)
          residual.extent_u = std::max(residual.extent_u, net.degree_u * std::fabs(f[i + stride] - f[i]));
        if (l < net.degree_v)
          residual.extent_v = std::max(residual.extent_v, net.degree_v * std::fabs(f[i + 1] - f[i]));
      }
    }
  }
  return residual;
}

double DepthOf(double w, double q, bool perspective) {
  return perspective ? w / q : q / w;
}

}  // namespace

std::uint8_t FallbackSolver::Solve(const Leaf& leaf, double x, double y, double limit,
                                   std::vector<FallbackRoot>* roots) {
  const bool perspective = (leaf.flags & kLeafPerspective) != 0;
  const DepthRule rule{perspective, (leaf.flags & kLeafWeightVaries) != 0,
                       (leaf.flags & kLeafDepthVaries) != 0};
  const auto push = [this](std::size_t depth) -> Piece& {
    while (stack_.size() <= depth) stack_.push_back(std::make_unique<Piece>());
    return *stack_[depth];
  };

  // Start from the leaf's own net. Pieces [0, depth) of the stack are waiting; the one above is scratch.
  std::size_t depth = 1;
  Piece& root = push(0);
  root.Set(leaf.degree_u, leaf.degree_v);
  std::copy_n(leaf.coefficients, kNetComponents * leaf.points(), root.storage.data());
  root.s_mid = root.t_mid = 0;
  root.s_half = root.t_half = 1;
  push(1);

  int pieces = 0;
  while (depth > 0) {
    // Take the top piece off the stack: swap it out so that its children may take its place.
    std::swap(stack_[depth - 1], stack_[depth]);
    const Piece* work = stack_[depth].get();
    --depth;
    if (++pieces > kMaxPieces) return kDoubtUnresolved;

    const BezierNet& net = work->net;
    const Residual residual = Measure(net, x, y);
    if (residual.Empty()) continue;
    double near_depth = INFINITY;
    for (int i = 0; i < net.points(); ++i)
      near_depth = std::min(near_depth, DepthOf(net.value[kW][i], net.value[kQ][i], perspective));
    if (near_depth > limit) continue;

    // Solve it if it is easy by now.
    Leaf piece;
    double monomials[kNetComponents * kMaxNetPoints];
    if (Certify(net, rule, &piece, monomials).certified) {
      piece.coefficients = monomials;
      FallbackRoot found;
      const SampleRoot result = kernel_scalar::SolveSample(piece, x, y, &found.hit);
      if (result == SampleRoot::kMiss) continue;
      if (result == SampleRoot::kHit) {
        found.hit.s = work->s_mid + found.hit.s * work->s_half;
        found.hit.t = work->t_mid + found.hit.t * work->t_half;
        found.jacobian_sign = piece.c11 * piece.c22 - piece.c12 * piece.c21;
        if (found.hit.depth < limit) roots->push_back(found);
        continue;
      }
    }
    if (residual.size() <=
        std::max(kFloorSamples, kRounding * std::max(residual.magnitude[0], residual.magnitude[1]))) {
      const int middle = (net.degree_u / 2) * net.stride() + net.degree_v / 2;
      const FallbackRoot found{
          {DepthOf(net.value[kW][middle], net.value[kQ][middle], perspective), work->s_mid, work->t_mid},
          0,
          kDoubtSolver};
      if (found.hit.depth < limit) roots->push_back(found);
      continue;
    }

    // Halve along the direction in which F varies more.
    push(depth + 2);
    Piece& low = *stack_[depth];
    Piece& high = *stack_[depth + 2];
    low.Set(net.degree_u, net.degree_v);
    high.Set(net.degree_u, net.degree_v);
    low.s_mid = high.s_mid = work->s_mid, low.s_half = high.s_half = work->s_half;
    low.t_mid = high.t_mid = work->t_mid, low.t_half = high.t_half = work->t_half;
    const Direction direction = residual.extent_v > residual.extent_u ? Direction::kV : Direction::kU;
    if (direction == Direction::kU) {
      low.s_half = high.s_half = work->s_half / 2;
      low.s_mid = work->s_mid - low.s_half;
      high.s_mid = work->s_mid + low.s_half;
    } else {
      low.t_half = high.t_half = work->t_half / 2;
      low.t_mid = work->t_mid - low.t_half;
      high.t_mid = work->t_mid + low.t_half;
    }
    Halve(net, direction, &low.net, &high.net);
    std::swap(stack_[depth + 1], stack_[depth + 2]);
    depth += 2;
  }
  return 0;
}

}  // namespace facetless
