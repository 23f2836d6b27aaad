#include "render/trace/fallback_solver.h"

#include <algorithm>
#include <cmath>

#include "render/nurbs/edge_on.h"

namespace facetless {
namespace {

// Forming F: a product and a difference.
constexpr double kRounding = 2 * 0x1p-53;

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
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, error[2] = {0, 0};
  double extent_u = 0, extent_v = 0;
  double weight = 0;  // the largest W: F is in samples times that

  bool Empty() const {
    for (int c = 0; c < 2; ++c) {
      if (low[c] > error[c] || high[c] < -error[c]) return true;
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
    double magnitude = 0;
    for (int i = 0; i < net.points(); ++i) {
      f[i] = value[i] - pixel * net.value[kW][i];
      residual.low[c] = std::min(residual.low[c], f[i]);
      residual.high[c] = std::max(residual.high[c], f[i]);
      residual.weight = std::max(residual.weight, net.value[kW][i]);
      magnitude = std::max(magnitude, std::fabs(value[i]) + std::fabs(pixel * net.value[kW][i]));
    }
    residual.error[c] =
        net.error[c == 0 ? kX : kY] + std::fabs(pixel) * net.error[kW] + kRounding * magnitude;
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

// The range of the depth over a piece, the net's error included. Requires W, in perspective Q, beyond its error;
// infinite otherwise.
struct DepthRange {
  double near = INFINITY, far = -INFINITY;
};

DepthRange MeasureDepth(const BezierNet& net, const DepthRule& rule) {
  const NetComponent over = rule.perspective ? kW : kQ, under = rule.perspective ? kQ : kW;
  DepthRange range;
  double divisor = INFINITY;
  for (int i = 0; i < net.points(); ++i) {
    const double depth = net.value[over][i] / net.value[under][i];
    range.near = std::min(range.near, depth);
    range.far = std::max(range.far, depth);
    divisor = std::min(divisor, net.value[under][i]);
  }
  if (!(divisor > 2 * net.error[under])) return {-INFINITY, INFINITY};
  const double size = std::max(std::fabs(range.near), std::fabs(range.far));
  const double error = 2 * NetDepthError(net, rule, size, divisor) + size * 0x1p-50;
  return {range.near - error, range.far + error};
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
  const double errors[kNetComponents] = {leaf.c11, leaf.c12, leaf.c21, leaf.c22};
  std::copy_n(errors, int{kNetComponents}, root.net.error);
  root.s_mid = root.t_mid = 0;
  root.s_half = root.t_half = 1;
  if (leaf.flags & kLeafEdgeOn) {
    const LineImage line = FitLine(root.net);
    return line.DistanceOf(x, y) > line.half_width ? 0 : kDoubtUnresolved;
  }
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
    const DepthRange depths = MeasureDepth(net, rule);
    if (depths.near > limit) continue;

    // Solve it if it is easy by now.
    Leaf piece;
    double monomials[kNetComponents * kMaxNetPoints];
    if (Certify(net, rule, kDoubleArithmetic, &piece, monomials).certified) {
      piece.coefficients = monomials;
      piece.u_mid = leaf.u_mid + work->s_mid * leaf.u_half, piece.u_half = work->s_half * leaf.u_half;
      piece.v_mid = leaf.v_mid + work->t_mid * leaf.v_half, piece.v_half = work->t_half * leaf.v_half;
      // A neighbour's net is rounded on its own: a root on the border may lie beyond both by their errors.
      piece.s_high = piece.t_high = 1 + piece.overlap();
      piece.s_low = piece.t_low = -piece.s_high;
      FallbackRoot found;
      const SampleRoot result = kernel_scalar::SolveSample(piece, x, y, &found.hit);
      if (result == SampleRoot::kMiss) continue;
      if (result == SampleRoot::kHit) {
        found.on_border = OnPatchBorder(piece, found.hit.s, found.hit.t);
        found.hit.s = work->s_mid + found.hit.s * work->s_half;
        found.hit.t = work->t_mid + found.hit.t * work->t_half;
        found.error_s = piece.root_error * work->s_half;
        found.error_t = piece.root_error * work->t_half;
        found.jacobian_sign = piece.c11 * piece.c22 - piece.c12 * piece.c21;
        if (found.hit.depth - found.hit.error <= limit) roots->push_back(found);
        continue;
      }
    }
    if (residual.size() <=
        std::max(kFloorSamples * residual.weight, 2 * std::max(residual.error[0], residual.error[1]))) {
      const double middle = 0.5 * (depths.near + depths.far);
      if (!std::isfinite(middle)) return kDoubtUnresolved;
      roots->push_back({{middle, work->s_mid, work->t_mid, depths.far - middle},
                        work->s_half,
                        work->t_half,
                        /*jacobian_sign=*/0,
                        /*proven=*/false});
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
