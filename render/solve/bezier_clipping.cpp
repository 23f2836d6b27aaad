#include "render/solve/bezier_clipping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/solve/whole_patches.h"

namespace facetless {
namespace {

constexpr const char* kName = "bezier-clipping";

bool IsDone(const RayNet& net, ClipAxis axis) {
  return net.size(axis) < kClipTolerance;
}

// Turns the lines of a net to its sides. Sides in a direction that is done have no length any more.
void TurnLines(RayNet& net) {
  for (const ClipAxis axis : {ClipAxis::kU, ClipAxis::kV}) {
    if (IsDone(net, axis)) continue;
    // The line along the sides in u bounds v, and the other way round.
    Vec2& normal = axis == ClipAxis::kU ? net.normal_v : net.normal_u;
    const Vec2 side = SideSum(net, axis);
    const double length = Length(side);
    normal = length > 0 ? Vec2{-side.y / length, side.x / length} : Vec2{};
  }
}

// The interval of the zeros of the distance from the line of an axis. It is made half as long as the tolerance, if it is
// shorter, so that it can be clipped again.
ClipInterval Clip(const RayNet& net, ClipAxis axis) {
  const ClipInterval clip =
      ZeroInterval(Distances(net, axis, axis == ClipAxis::kU ? net.normal_u : net.normal_v), 0);
  const double missing = 0.5 * kClipTolerance / net.size(axis) - clip.size();
  if (clip.empty() || !(missing > 0)) return clip;
  return {std::max(0.0, clip.low - 0.5 * missing), std::min(1.0, clip.high + 0.5 * missing)};
}

class BezierClipping final : public Solver {
 public:
  BezierClipping(const SolverScene& scene, std::vector<SolverPiece> pieces)
      : scene_(scene), pieces_(std::move(pieces)), most_points_(MostPoints(scene)) {}

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece); }
  std::unique_ptr<SolverState> MakeState() const override {
    return std::make_unique<ClipState>(most_points_);
  }
  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    ++state.counters.solves;
    state.End(ClipPatch(scene_, start.surface, ray, static_cast<ClipState&>(state).nets, state));
  }

 private:
  const SolverScene& scene_;
  std::vector<SolverPiece> pieces_;
  int most_points_;
};

Result<std::unique_ptr<const Solver>> Make(const SolverScene& scene, std::uint64_t max_bytes,
                                           const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = WholePatches(kName, scene, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<BezierClipping>(scene, std::move(pieces).value()));
}

}  // namespace

SolverStop ClipPatch(const SolverScene& scene, std::uint32_t patch, const SolverRay& ray, NetStack& nets,
                     SolverState& state) {
  const SolverPatch& surface = scene.patches()[patch];
  if (!nets.Load(scene, surface, ray)) return SolverStop::kNoRoot;
  const std::size_t first = state.roots.size();
  const std::size_t most = static_cast<std::size_t>(2 * surface.degree_u * surface.degree_v);
  while (!nets.empty()) {
    RayNet& net = nets.top();
    TurnLines(net);
    // A part that is small enough is a root if it still has zeros of both distances.
    if (IsDone(net, ClipAxis::kU) && IsDone(net, ClipAxis::kV)) {
      if (!Clip(net, ClipAxis::kU).empty() && !Clip(net, ClipAxis::kV).empty()) {
        if (state.roots.size() - first == most) return SolverStop::kSteps;
        state.AddRoot({patch, net.middle_u(), net.middle_v()});
      }
      nets.Pop();
      continue;
    }
    if (!state.Work()) return SolverStop::kWork;
    ++state.counters.iterations;
    const ClipAxis axis = net.next;
    const ClipInterval clip = Clip(net, axis);
    if (clip.empty()) {
      nets.Pop();
      continue;
    }
    net.next = Other(axis);
    // Halve what the clip has hardly made smaller. Both halves go on with the other axis.
    if (!IsDone(net, axis)) {
      if (clip.size() > kClipShare)
        nets.Halve(axis);
      else
        Restrict(net, axis, clip.low, clip.high);
    }
  }
  return state.roots.size() > first ? SolverStop::kRoot : SolverStop::kNoRoot;
}

SolverInfo BezierClippingInfo() {
  SolverInfo info;
  info.name = kName;
  info.title = "Bézier clipping";
  info.source =
      "T. Nishita, T. Sederberg, M. Kakimoto, Ray tracing trimmed rational surface patches, SIGGRAPH 1990, "
      "section 3";
  info.does =
      "It bounds the parameters of the roots by the convex hulls of distance polynomials, and cuts the patch "
      "down.";
  info.does_not =
      "Rounding loses roots on borders, and some are reported twice; on surfaces that are seen edge-on, "
      "roots are invented.";
  info.make = Make;
  return info;
}

}  // namespace facetless
