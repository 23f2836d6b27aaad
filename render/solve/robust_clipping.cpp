#include "render/solve/robust_clipping.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/solve/clip.h"
#include "render/solve/patch_jet.h"
#include "render/solve/whole_patches.h"

namespace facetless {
namespace {

constexpr const char* kName = "robust-clipping";
constexpr double kTolerancePx = 1e-8;
// A clip that leaves more than this share of the interval has not succeeded.
constexpr double kShare = 0.8;
// Parts are not divided below this size in parameters.
constexpr double kFinest = 0x1p-50;
// A part whose numbers are all below this multiple of their rounding error cannot be divided with any sense: a clip leaves
// 3 errors of it, and more than kShare of a part of less than 4.
constexpr double kNoise = 8;
// The sum of two sides is short below this share of the extent of the net. Lines are nearly parallel if the sine of their
// angle is below the same number.
constexpr double kPoor = 0.25;

// The most that a shift by rounding makes parts of roots larger. At a double root, it is the square root of the error.
constexpr double kMostShift = 0x1p-24;
// Parts that are not farther apart than this, and twice their size, stand for the same root.
constexpr double kSameRoot = 0x1p-44;
// The roundings of a parameter, which is the sum of the cuts.
constexpr double kParameterRoundings = 16;

// A root, and the part of the patch that it stands for.
struct FoundPart {
  double u_low, u_high, v_low, v_high;
};

struct RobustState final : SolverState {
  RobustState(int most_points, int most_roots)
      : nets(most_points, true), found(static_cast<std::size_t>(most_roots)) {}
  NetStack nets;
  std::vector<FoundPart> found;
};

// The length of the net on the screen along an axis: the longest difference of neighbours, times their number.
double Extent(const RayNet& net, ClipAxis axis) {
  const int width = net.degree_v + 1;
  const int step = axis == ClipAxis::kU ? width : 1;
  double longest = 0;
  for (int i = 0; i + (axis == ClipAxis::kU) <= net.degree_u; ++i)
    for (int j = 0; j + (axis == ClipAxis::kV) <= net.degree_v; ++j) {
      const int k = i * width + j;
      longest =
          std::max({longest, std::fabs(net.f[k + step] - net.f[k]), std::fabs(net.g[k + step] - net.g[k])});
    }
  return longest * net.degree(axis);
}

Vec2 Unit(Vec2 a) {
  const double length = Length(a);
  return length > 0 ? Vec2{a.x / length, a.y / length} : Vec2{};
}

// The lines of a clip, by their unit normals (law 2).
struct ClipLines {
  Vec2 normal;
  bool both = false;  // also clip against the perpendicular line
};
ClipLines LinesOf(const RayNet& net, ClipAxis axis, double extent, double extent_other) {
  const Vec2 side = SideSum(net, Other(axis)), across = SideSum(net, axis);
  const bool has_side = Length(side) > 2 * kPoor * extent_other && extent_other > 0;
  const bool has_across = Length(across) > 2 * kPoor * extent && extent > 0;
  const Vec2 along = Unit(side), over = Unit(across);
  if (has_side && has_across) return {{-along.y, along.x}, std::fabs(Cross(along, over)) < kPoor};
  if (has_side) return {{-along.y, along.x}, true};
  if (has_across) return {over, true};
  return {{1, 0}, true};
}

ClipInterval Clip(const RayNet& net, ClipAxis axis, const ClipLines& lines, double slack) {
  const ClipInterval clip = ZeroInterval(Distances(net, axis, lines.normal), slack);
  if (!lines.both || clip.empty()) return clip;
  const ClipInterval other = ZeroInterval(Distances(net, axis, {-lines.normal.y, lines.normal.x}), slack);
  if (other.empty()) return other;
  return {std::max(clip.low, other.low), std::min(clip.high, other.high)};
}

// Cuts the net down to an interval, which is rounded itself.
void CutDown(RayNet& net, ClipAxis axis, ClipInterval to) {
  constexpr double margin = 4 * 0x1p-53;
  Restrict(net, axis, std::max(0.0, to.low - margin), std::min(1.0, to.high + margin));
}

class RobustClipping final : public Solver {
 public:
  RobustClipping(const SolverScene& scene, std::vector<SolverPiece> pieces)
      : scene_(scene), pieces_(std::move(pieces)), most_points_(MostPoints(scene)) {
    for (const SolverPatch& patch : scene.patches())
      most_roots_ = std::max(most_roots_, 2 * patch.degree_u * patch.degree_v);
  }

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece); }
  std::unique_ptr<SolverState> MakeState() const override {
    return std::make_unique<RobustState>(most_points_, most_roots_);
  }
  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    ++state.counters.solves;
    state.End(Search(start.surface, ray, static_cast<RobustState&>(state)));
  }

 private:
  enum class Candidate : std::uint8_t { kRoot, kBehind, kOff, kLarge };

  SolverStop Search(std::uint32_t patch, const SolverRay& ray, RobustState& state) const {
    const SolverPatch& surface = scene_.patches()[patch];
    NetStack& nets = state.nets;
    if (!nets.Load(scene_, surface, ray)) return SolverStop::kNoRoot;
    const std::size_t most = static_cast<std::size_t>(2 * surface.degree_u * surface.degree_v);
    std::size_t found = 0;
    bool off = false;
    while (!nets.empty()) {
      RayNet& net = nets.top();
      const double largest = Largest(net), error = RoundingError(net);
      const bool noise = largest <= kNoise * error;
      const bool finest = net.size(ClipAxis::kU) <= kFinest && net.size(ClipAxis::kV) <= kFinest;
      if (noise || finest ||
          (net.size(ClipAxis::kU) <= kRobustParameters && net.size(ClipAxis::kV) <= kRobustParameters)) {
        if (Known(net, state.found, found)) {
          nets.Pop();
          continue;
        }
        if (!state.Work()) return SolverStop::kWork;
        // The finest part is as exact as parameters can be.
        const double allowed = (finest ? std::max(largest, kNoise * error) : kNoise * error) / nets.scale();
        const PatchJet<3> jet = EvaluatePatch<3>(&scene_.screen(surface)->x, surface.degree_u,
                                                 surface.degree_v, net.middle_u(), net.middle_v());
        const Candidate candidate = Judge(jet, ray, largest / nets.scale(), allowed);
        if (candidate != Candidate::kLarge) {
          if (candidate == Candidate::kRoot) {
            if (found == most) return SolverStop::kSteps;
            state.found[found++] = PartOf(net, jet, ray, error / nets.scale());
            state.AddRoot({patch, net.middle_u(), net.middle_v()});
          }
          off = off || candidate == Candidate::kOff;
          nets.Pop();
          continue;
        }
      }
      if (!state.Work()) return SolverStop::kWork;
      ++state.counters.iterations;
      Divide(nets, largest, error);
    }
    return found > 0 ? SolverStop::kRoot : off ? SolverStop::kDiverged : SolverStop::kNoRoot;
  }

  // Clips or halves the top, or drops it.
  static void Divide(NetStack& nets, double largest, double error) {
    RayNet& net = nets.top();
    // The distance from a line is rounded, too.
    const double slack = 1.5 * error + 4 * 0x1p-53 * largest;
    const double extent_u = Extent(net, ClipAxis::kU), extent_v = Extent(net, ClipAxis::kV);
    const bool fine_u = net.size(ClipAxis::kU) <= kFinest, fine_v = net.size(ClipAxis::kV) <= kFinest;
    const ClipAxis longer = fine_v || (!fine_u && extent_u >= extent_v) ? ClipAxis::kU : ClipAxis::kV;
    ClipInterval half;
    for (const ClipAxis axis : {longer, Other(longer)}) {
      if (axis == ClipAxis::kU ? fine_u : fine_v) continue;
      const double extent = axis == ClipAxis::kU ? extent_u : extent_v;
      const double extent_other = axis == ClipAxis::kU ? extent_v : extent_u;
      const ClipInterval clip = Clip(net, axis, LinesOf(net, axis, extent, extent_other), slack);
      if (clip.empty()) {
        nets.Pop();
        return;
      }
      if (clip.size() <= kShare) {
        CutDown(net, axis, clip);
        return;
      }
    }
    nets.Halve(longer);
  }

  // Judges the point of the surface at the middle of a part (law 4). `largest` is that of the net, and `allowed` is how far
  // rounding may move it, in pixels times W.
  static Candidate Judge(const PatchJet<3>& jet, const SolverRay& ray, double largest, double allowed) {
    const double w = std::fabs(jet.value[2]);
    const auto off = [&](const std::array<double, 3>& p) {
      return std::max(std::fabs(p[0] - ray.x * p[2]), std::fabs(p[1] - ray.y * p[2]));
    };
    // The parameters have been rounded in each cut.
    const double rounded = kParameterRoundings * 0x1p-53 * (off(jet.du) + off(jet.dv));
    if (!(largest <= std::max({0.5 * kTolerancePx * w, allowed, rounded}))) return Candidate::kLarge;
    if (!(off(jet.value) <= std::max({kTolerancePx * w, allowed, rounded}))) return Candidate::kOff;
    return jet.value[2] > 0 ? Candidate::kRoot : Candidate::kBehind;
  }

  // The part of a root, and around it what rounding makes of the root: the error, as a shift of the parameters.
  static FoundPart PartOf(const RayNet& net, const PatchJet<3>& jet, const SolverRay& ray, double error) {
    const double fu = jet.du[0] - ray.x * jet.du[2], fv = jet.dv[0] - ray.x * jet.dv[2];
    const double gu = jet.du[1] - ray.y * jet.du[2], gv = jet.dv[1] - ray.y * jet.dv[2];
    const double shift = error / std::fabs(fu * gv - fv * gu);
    // The comparisons also hold for what is not a number.
    const auto bounded = [](double x) { return x < kMostShift ? x : kMostShift; };
    const double du = bounded(kNoise * shift * (std::fabs(fv) + std::fabs(gv)));
    const double dv = bounded(kNoise * shift * (std::fabs(fu) + std::fabs(gu)));
    return {net.u_low - du, net.u_high + du, net.v_low - dv, net.v_high + dv};
  }

  // Whether the part touches that of an earlier root, which then stands for both.
  static bool Known(const RayNet& net, std::vector<FoundPart>& parts, std::size_t count) {
    // Clips of what rounding leaves of a root may take out pieces between two parts.
    const double margin_u = kSameRoot + 2 * net.size(ClipAxis::kU),
                 margin_v = kSameRoot + 2 * net.size(ClipAxis::kV);
    for (std::size_t i = 0; i < count; ++i) {
      FoundPart& part = parts[i];
      if (net.u_low > part.u_high + margin_u || net.u_high < part.u_low - margin_u) continue;
      if (net.v_low > part.v_high + margin_v || net.v_high < part.v_low - margin_v) continue;
      part = {std::min(part.u_low, net.u_low), std::max(part.u_high, net.u_high),
              std::min(part.v_low, net.v_low), std::max(part.v_high, net.v_high)};
      return true;
    }
    return false;
  }

  const SolverScene& scene_;
  std::vector<SolverPiece> pieces_;
  int most_points_;
  int most_roots_ = 0;
};

Result<std::unique_ptr<const Solver>> Make(const SolverScene& scene, std::uint64_t max_bytes,
                                           const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = WholePatches(kName, scene, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<RobustClipping>(scene, std::move(pieces).value()));
}

}  // namespace

SolverInfo RobustClippingInfo() {
  SolverInfo info;
  info.name = kName;
  info.title = "Robust Bézier clipping";
  info.source =
      "A. Efremov, V. Havran, H.-P. Seidel, Robust and numerically stable Bézier clipping method for ray "
      "tracing NURBS surfaces, SCCG 2005";
  info.does =
      "It clips with bounds of the rounding errors, with lines that suit folds and collapsed edges, and "
      "reports each root once.";
  info.does_not =
      "Nothing is proven: rays that miss by less than the rounding error may hit, and roots that rounding "
      "cannot tell apart are one.";
  info.tolerance_px = kTolerancePx;
  info.make = Make;
  return info;
}

}  // namespace facetless
