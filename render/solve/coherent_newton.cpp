#include "render/solve/coherent_newton.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/solve/clip.h"
#include "render/solve/patch_cells.h"
#include "render/solve/patch_jet.h"
#include "render/solve/whole_patches.h"

namespace facetless {
namespace {

constexpr const char* kName = "coherent-newton";
constexpr double kTolerancePx = 1e-8;
// A determinant below this share of the products that it is the difference of has no correct digits.
constexpr double kSingular = 0x1p-48;

// Calls visit(difference) for the differences of neighbours along an axis that are not zero.
template <typename Visit>
void ForEachDifference(const RayNet& net, ClipAxis axis, const Visit& visit) {
  const int width = net.degree_v + 1;
  const int step = axis == ClipAxis::kU ? width : 1;
  for (int i = 0; i + (axis == ClipAxis::kU) <= net.degree_u; ++i)
    for (int j = 0; j + (axis == ClipAxis::kV) <= net.degree_v; ++j) {
      const int k = i * width + j;
      const Vec2 difference{net.f[k + step] - net.f[k], net.g[k + step] - net.g[k]};
      if (difference.x != 0 || difference.y != 0) visit(difference);
    }
}

class CoherentNewton final : public Solver {
 public:
  CoherentNewton(const SolverScene& scene, std::vector<SolverPiece> pieces, PatchCells cells)
      : scene_(scene),
        pieces_(std::move(pieces)),
        cells_(std::move(cells)),
        most_points_(MostPoints(scene)) {}

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece) + cells_.bytes(); }
  std::unique_ptr<SolverState> MakeState() const override {
    return std::make_unique<CoherentNewtonState>(most_points_, scene_.patches().size());
  }
  void BeginRow(int, SolverState& state) const override { ++static_cast<CoherentNewtonState&>(state).row; }

  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& base) const override {
    auto& state = static_cast<CoherentNewtonState&>(base);
    ++state.counters.solves;
    const CellBlock block = cells_.Around(start.surface, ray.x, ray.y);
    if (block.empty()) {
      ++state.missed;
      return state.End(SolverStop::kNoRoot);
    }
    CoherentNewtonState::Kept& kept = state.kept[start.surface];
    if (kept.row != state.row) {
      ++state.first;
    } else {
      // Look for a second root, then iterate from the root of the neighbour.
      const SolverPatch& patch = scene_.patches()[start.surface];
      if (!state.Work()) return state.End(SolverStop::kWork);
      if (!IsUnobstructed(patch, ray, block, state)) {
        ++state.obstructed;
      } else if (Iterate(ray, patch, kept, state)) {
        ++state.by_newton;
        state.AddRoot({start.surface, kept.u, kept.v});
        return state.End(SolverStop::kRoot);
      } else {
        ++state.failed;
      }
    }
    const std::size_t first = state.roots.size();
    const SolverStop stop = ClipPatch(scene_, start.surface, ray, state.nets, state);
    Keep(start.surface, first, state);
    state.End(stop);
  }

 private:
  // The test of law 3.
  bool IsUnobstructed(const SolverPatch& patch, const SolverRay& ray, const CellBlock& block,
                      CoherentNewtonState& state) const {
    if (!state.nets.Load(scene_, patch, ray)) return false;
    RayNet& net = state.nets.top();
    Restrict(net, ClipAxis::kU, block.u_low(), block.u_high());
    Restrict(net, ClipAxis::kV, block.v_low(), block.v_high());
    return HasAtMostOneRoot(net);
  }

  // Newton's method from `at`. Returns true, with the root in `at`, if it arrives.
  bool Iterate(const SolverRay& ray, const SolverPatch& patch, CoherentNewtonState::Kept& at,
               CoherentNewtonState& state) const {
    double u = at.u, v = at.v;
    for (int step = 0; step < kMostCoherentSteps; ++step) {
      if (!state.Work()) return false;
      ++state.counters.iterations;
      const PatchJet<3> jet =
          EvaluatePatch<3>(&scene_.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
      const double f = jet.value[0] - ray.x * jet.value[2], g = jet.value[1] - ray.y * jet.value[2];
      const double fu = jet.du[0] - ray.x * jet.du[2], fv = jet.dv[0] - ray.x * jet.dv[2];
      const double gu = jet.du[1] - ray.y * jet.du[2], gv = jet.dv[1] - ray.y * jet.dv[2];
      const double determinant = fu * gv - fv * gu;
      if (!(std::fabs(determinant) > kSingular * (std::fabs(fu * gv) + std::fabs(fv * gu)))) return false;
      u -= (f * gv - fv * g) / determinant;
      v -= (fu * g - f * gu) / determinant;
      const bool near = std::max(std::fabs(f), std::fabs(g)) <= kTolerancePx * jet.value[2];
      const double beyond = near ? kRootBorder : 1;
      if (!(u >= -beyond && u <= 1 + beyond && v >= -beyond && v <= 1 + beyond)) return false;
      if (!near) continue;
      at.u = u;
      at.v = v;
      return true;
    }
    return false;
  }

  // Keeps the nearest of the roots from `first` on.
  void Keep(std::uint32_t patch, std::size_t first, CoherentNewtonState& state) const {
    const SolverPatch& surface = scene_.patches()[patch];
    const bool perspective = scene_.frame().projection == Projection::kPerspective;
    double nearest = INFINITY;
    for (std::size_t i = first; i < state.roots.size(); ++i) {
      const SolverRoot& root = state.roots[i];
      const PatchJet<4> jet =
          EvaluatePatch<4>(&scene_.screen(surface)->x, surface.degree_u, surface.degree_v, root.u, root.v);
      const double depth = perspective ? jet.value[2] / jet.value[3] : jet.value[3] / jet.value[2];
      if (!(depth < nearest)) continue;
      nearest = depth;
      state.kept[patch] = {state.row, root.u, root.v};
    }
  }

  const SolverScene& scene_;
  std::vector<SolverPiece> pieces_;
  PatchCells cells_;
  int most_points_;
};

Result<std::unique_ptr<const Solver>> Make(const SolverScene& scene, std::uint64_t max_bytes,
                                           const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = WholePatches(kName, scene, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  const std::uint64_t used = pieces.value().size() * sizeof(SolverPiece);
  Result<PatchCells> cells =
      PatchCells::Make(scene, max_bytes == 0 ? 0 : std::max<std::uint64_t>(max_bytes - used, 1), execution);
  if (!cells.ok() && cells.error().code == ErrorCode::kLimitExceeded) return PiecesTooLarge(kName, max_bytes);
  if (!cells.ok()) return cells.error();
  return std::unique_ptr<const Solver>(
      std::make_unique<CoherentNewton>(scene, std::move(pieces).value(), std::move(cells).value()));
}

}  // namespace

bool HasAtMostOneRoot(const RayNet& net) {
  // Find the outermost differences along u, on both sides.
  Vec2 right, left;
  bool any = false;
  ForEachDifference(net, ClipAxis::kU, [&](Vec2 p) {
    if (!any) right = left = p;
    any = true;
    if (Cross(right, p) < 0) right = p;
    if (Cross(left, p) > 0) left = p;
  });
  if (!any) return false;
  // All differences along v must lie on the same side of both.
  bool passes = true, any_across = false;
  double sign = 0;
  Vec2 across;
  ForEachDifference(net, ClipAxis::kV, [&](Vec2 q) {
    if (!any_across) {
      sign = Cross(right, q) > 0 ? 1 : -1;
      across = q;
    }
    any_across = true;
    passes = passes && sign * Cross(right, q) > 0 && sign * Cross(left, q) > 0;
  });
  // All others along u must lie between the outermost, less than half a turn apart.
  ForEachDifference(net, ClipAxis::kU, [&](Vec2 p) {
    passes = passes && Cross(right, p) >= 0 && Cross(p, left) >= 0 && sign * Cross(p, across) > 0;
  });
  return passes && any_across;
}

SolverInfo CoherentNewtonInfo() {
  SolverInfo info;
  info.name = kName;
  info.title = "Newton with coherence";
  info.source =
      "S.-W. Wang, Z.-C. Shih, R.-C. Chang, An efficient and stable ray tracing algorithm for parametric "
      "surfaces, Journal of Information Science and Engineering 18, 2002";
  info.does =
      "It starts Newton's method at the root of the ray on the left where the patch has one root at most, "
      "and clips elsewhere.";
  info.does_not = "Where it clips, it loses and invents roots as bezier-clipping does.";
  info.tolerance_px = kTolerancePx;
  info.make = Make;
  return info;
}

}  // namespace facetless
