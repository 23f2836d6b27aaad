#include "render/trace/fallback_solver.h"

#include <algorithm>
#include <cmath>

#include "render/nurbs/edge_on.h"

namespace facetless {

struct FallbackSolver::Piece : OwnedNet {
  double s_mid = 0, s_half = 1, t_mid = 0, t_half = 1;  // which part of the leaf it is
};

// One ray in one leaf, and the roots found so far.
struct FallbackSolver::Task {
  double x, y;
  double limit;  // of the depth
  ParameterRect rect;
  DepthRule rule;
  std::vector<FallbackRoot>* roots;
};

FallbackSolver::FallbackSolver(const NetOperations& nets) : nets_(nets) {}
FallbackSolver::~FallbackSolver() = default;

namespace {

// The range of the depth over a piece, including the error of the net. It is infinite unless W (Q in
// perspective views) exceeds its error.
struct DepthRange {
  double near = INFINITY, far = -INFINITY;
};

DepthRange MeasureDepth(const BezierNet& net, const DepthRule& rule) {
  const NetComponent over = rule.perspective ? kW : kQ, under = rule.perspective ? kQ : kW;
  DepthRange range;
  double divisor = INFINITY;
  for (int i = 0; i < net.points(); ++i) {
    const double depth = net.at(i, over) / net.at(i, under);
    range.near = std::min(range.near, depth);
    range.far = std::max(range.far, depth);
    divisor = std::min(divisor, net.at(i, under));
  }
  const double size = std::max(std::fabs(range.near), std::fabs(range.far));
  const double error = NetDepthError(net, rule, size, divisor) + size * 0x1p-50;
  if (!(error < INFINITY)) return {-INFINITY, INFINITY};
  return {range.near - error, range.far + error};
}

}  // namespace

bool FallbackSolver::Misses(const HardLeaf& leaf, double x, double y, RayWork* work) const {
  if (leaf.kind != HardKind::kSubdivide || work->exhausted()) return false;
  BezierNet net;
  net.degree_u = leaf.degree_u;
  net.degree_v = leaf.degree_v;
  net.value = const_cast<double*>(leaf.net);  // it is only read
  std::copy_n(leaf.error, int{kNetComponents}, net.error);
  if (!nets_.residual(net, x, y).empty) return false;
  // What Solve spends on the leaf and on its first piece.
  RayWork spent = *work;
  spent.Spend(leaf.points());
  spent.Spend(leaf.points());
  if (spent.exhausted()) return false;
  *work = spent;
  return true;
}

std::uint8_t FallbackSolver::Solve(const HardLeaf& leaf, const ParameterRect& rect, double x, double y,
                                   double limit, RayWork* work_left, std::vector<FallbackRoot>* roots,
                                   bool whole) {
  if (work_left->exhausted()) return kDoubtLimit;
  work_left->Spend(leaf.points());
  const Task task{x, y, limit, rect, RuleOf(leaf), roots};

  // Start from the leaf's own net. Pieces [0, depth) of the stack are waiting; the one above is scratch.
  std::size_t depth = 1;
  Piece& root = StackAt(0);
  root.SetDegrees(leaf.degree_u, leaf.degree_v);
  std::copy_n(leaf.net, kNetComponents * leaf.points(), root.storage.data());
  std::copy_n(leaf.error, int{kNetComponents}, root.net.error);
  root.s_mid = root.t_mid = 0;
  root.s_half = root.t_half = 1;
  if (leaf.kind == HardKind::kGivenUp) return nets_.residual(root.net, x, y).empty ? 0 : kDoubtLimit;
  if (leaf.kind == HardKind::kEdgeOn) {
    const LineImage line = FitLine(root.net);
    return line.DistanceToLine(x, y) > line.half_width ? 0 : kDoubtUnresolved;
  }
  StackAt(1);

  int pieces = 0;
  while (depth > 0) {
    // Take the top piece off the stack: swap it out so that its children may take its place.
    std::swap(stack_[depth - 1], stack_[depth]);
    const Piece* work = stack_[depth].get();
    --depth;
    if (++pieces > kMaxPieces) return kDoubtUnresolved;
    work_left->Spend(work->net.points());
    if (work_left->exhausted()) return kDoubtLimit;

    const BezierNet& net = work->net;
    const Residual residual = nets_.residual(net, x, y);
    if (residual.empty) continue;
    if (limit < INFINITY && MeasureDepth(net, task.rule).near > limit) continue;

    // Solve the piece if it can be certified. The whole leaf of a view was not certified before, so do not try it
    // again.
    if ((pieces > 1 || whole) && SolveCertified(*work, task)) continue;
    if (pieces == 1 && whole) {
      const LineImage line = FitLine(net);
      if (line.is_line) return line.DistanceToLine(x, y) > line.half_width ? 0 : kDoubtUnresolved;
    }
    if (residual.size <= std::max(kFloorSamples * residual.weight, 2 * residual.error)) {
      if (!AddUnprovenRoot(*work, task)) return kDoubtUnresolved;
      continue;
    }

    // Halve along the direction in which F varies more.
    HalvePiece(*work, residual.extent.v > residual.extent.u ? Direction::kV : Direction::kU, depth);
    depth += 2;
  }
  return 0;
}

FallbackSolver::Piece& FallbackSolver::StackAt(std::size_t depth) {
  while (stack_.size() <= depth) stack_.push_back(std::make_unique<Piece>());
  return *stack_[depth];
}

bool FallbackSolver::SolveCertified(const Piece& work, const Task& task) const {
  CertifiedLeaf piece;
  double monomials[kNetComponents * kMaxNetPoints];
  if (!nets_.certify(work.net, task.rule, kDoubleArithmetic, &piece, monomials).certified) return false;
  piece.coefficients = monomials;
  const ParameterRect& rect = task.rect;
  piece.borders = BordersOf(
      {rect.U(work.s_mid), work.s_half * rect.u_half, rect.V(work.t_mid), work.t_half * rect.v_half});
  // A neighbour's net is rounded on its own: a root on the border may lie beyond both by their errors, and
  // a piece reaches past its own by as much.
  const double root_error = piece.RootError(kDoubleArithmetic);
  FallbackRoot found;
  const SampleRoot result = kernel_scalar::SolveSample(piece, kDoubleArithmetic, task.x, task.y, &found.hit);
  if (result == SampleRoot::kMiss) return true;
  if (result != SampleRoot::kHit) return false;
  found.on_border = OnPatchBorder(piece, root_error, found.hit.s, found.hit.t);
  found.hit.s = work.s_mid + found.hit.s * work.s_half;
  found.hit.t = work.t_mid + found.hit.t * work.t_half;
  found.error_s = root_error * work.s_half;
  found.error_t = root_error * work.t_half;
  found.jacobian_sign = piece.c11 * piece.c22 - piece.c12 * piece.c21;
  found.half_s = work.s_half;
  found.half_t = work.t_half;
  // H of the moved ray differs by C·d·W/W(0,0) at the root, so by law 1 of leaf.h the root moves by at most that
  // over 1 − kMaxKappa.
  constexpr double kSpread = 1 / (1 - kMaxKappa);
  double least = INFINITY, most = 0;
  for (int i = 0; i < work.net.points(); ++i) {
    least = std::min(least, work.net.at(i, kW));
    most = std::max(most, work.net.at(i, kW));
  }
  const double moved =
      kSpread * (most / least) *
      std::max(std::fabs(piece.c11) + std::fabs(piece.c12), std::fabs(piece.c21) + std::fabs(piece.c22));
  found.spread_s = moved * work.s_half;
  found.spread_t = moved * work.t_half;
  if (found.hit.depth - found.hit.error <= task.limit) task.roots->push_back(found);
  return true;
}

bool FallbackSolver::AddUnprovenRoot(const Piece& work, const Task& task) {
  const DepthRange depths = MeasureDepth(work.net, task.rule);
  const double middle = 0.5 * (depths.near + depths.far);
  if (!std::isfinite(middle)) return false;
  task.roots->push_back({{middle, work.s_mid, work.t_mid, depths.far - middle},
                         work.s_half,
                         work.t_half,
                         /*jacobian_sign=*/0,
                         /*proven=*/false});
  return true;
}

void FallbackSolver::HalvePiece(const Piece& work, Direction direction, std::size_t depth) {
  StackAt(depth + 2);
  Piece& low = *stack_[depth];
  Piece& high = *stack_[depth + 2];
  low.SetDegrees(work.net.degree_u, work.net.degree_v);
  high.SetDegrees(work.net.degree_u, work.net.degree_v);
  low.s_mid = high.s_mid = work.s_mid;
  low.s_half = high.s_half = work.s_half;
  low.t_mid = high.t_mid = work.t_mid;
  low.t_half = high.t_half = work.t_half;
  if (direction == Direction::kU) {
    low.s_half = high.s_half = work.s_half / 2;
    low.s_mid = work.s_mid - low.s_half;
    high.s_mid = work.s_mid + low.s_half;
  } else {
    low.t_half = high.t_half = work.t_half / 2;
    low.t_mid = work.t_mid - low.t_half;
    high.t_mid = work.t_mid + low.t_half;
  }
  nets_.halve(work.net, direction, &low.net, &high.net);
  std::swap(stack_[depth + 1], stack_[depth + 2]);
}

}  // namespace facetless
