#include "render/solve/gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/solve/ray_random.h"
#include "render/solve/screen_distance.h"
#include "render/solve/whole_patches.h"

namespace facetless {
namespace {

constexpr const char* kName = "gradient";

// An iterate may leave its patch by this much.
constexpr double kBeyond = 0.1;
// A descent whose g has grown by this factor does not come back.
constexpr double kGrowth = 4;

bool Within(double t, double beyond) {
  return t >= -beyond && t <= 1 + beyond;
}

class Gradient final : public Solver {
 public:
  Gradient(const SolverScene& scene, std::vector<SolverPiece> pieces)
      : scene_(scene), pieces_(std::move(pieces)) {
    for (const SolverPatch& patch : scene.patches()) accuracies_.push_back(Accuracy(patch));
  }

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override {
    return pieces_.size() * sizeof(SolverPiece) + accuracies_.size() * sizeof(double);
  }

  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    ++state.counters.solves;
    if (start.from_map) return state.End(Descend(ray, start.surface, {start.u, start.v}, state));

    // Step 1: random points, and the value of g at each.
    std::array<Vec2, kRandomPoints + 1> points;
    std::array<double, kRandomPoints + 1> values;
    RayRandom random(ray, start);
    double least = INFINITY;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!state.Work()) return state.End(SolverStop::kWork);
      points[k] = {start.u, start.v};
      if (k > 0) {
        const double s = random.Next(), t = random.Next();
        points[k] = {start.u_low + s * (start.u_high - start.u_low),
                     start.v_low + t * (start.v_high - start.v_low)};
      }
      values[k] = At(ray, start.surface, points[k].x, points[k].y).g;
      // Step 2: the least value.
      least = std::fmin(least, values[k]);
    }
    // Step 3: descents from all points that are nearly as good.
    SolverStop last = SolverStop::kLeft;
    const std::size_t before = state.roots.size();
    for (std::size_t k = 0; k < points.size() && last != SolverStop::kWork; ++k)
      if (values[k] - least <= accuracies_[start.surface])
        last = Descend(ray, start.surface, points[k], state);
    state.End(last != SolverStop::kWork && state.roots.size() > before ? SolverStop::kRoot : last);
  }

 private:
  // ε₀ of equation 3.
  double Accuracy(const SolverPatch& patch) const {
    const ViewProjection::Point* points = scene_.screen(patch);
    double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
    for (int k = 0; k < patch.points(); ++k) {
      if (!(points[k].w > 0)) return 0;  // the net has no diagonal: the best points alone begin a descent
      const double x = points[k].x / points[k].w, y = points[k].y / points[k].w;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
    return kAccuracyShare * kAccuracyShare *
           ((right - left) * (right - left) + (bottom - top) * (bottom - top));
  }

  ScreenDistance At(const SolverRay& ray, std::uint32_t index, double u, double v) const {
    const SolverPatch& patch = scene_.patches()[index];
    return DistanceFrom(ray,
                        EvaluatePatch<3>(&scene_.screen(patch)->x, patch.degree_u, patch.degree_v, u, v));
  }

  SolverStop Descend(const SolverRay& ray, std::uint32_t patch, Vec2 at, SolverState& state) const {
    constexpr double kTolerance = kDescentTolerancePx * kDescentTolerancePx;
    double weight = 0, most = INFINITY;
    for (int step = 0; step <= kMostGradientSteps; ++step) {
      if (!state.Work()) return SolverStop::kWork;
      const ScreenDistance here = At(ray, patch, at.x, at.y);
      if (here.g < kTolerance) return Finish(ray, patch, at, state);
      if (here.g == INFINITY) return SolverStop::kLeft;
      if (step == 0) {
        weight = kWeight / here.speed2;
        most = kGrowth * here.g;
      }
      // The comparison also ends descents whose g is not a number.
      if (!(here.g <= most)) return SolverStop::kDiverged;
      ++state.counters.iterations;
      // Equation 4.
      const double step_u = -weight * here.du, step_v = -weight * here.dv;
      if (!(std::fabs(step_u) > kResolution || std::fabs(step_v) > kResolution)) return SolverStop::kDiverged;
      at = {at.x + step_u, at.y + step_v};
      if (!Within(at.x, kBeyond) || !Within(at.y, kBeyond)) return SolverStop::kLeft;
    }
    return SolverStop::kSteps;
  }

  // Adds a root. One that is outside the patch moves to its border if it is within the tolerance there, too.
  SolverStop Finish(const SolverRay& ray, std::uint32_t patch, Vec2 at, SolverState& state) const {
    if (!Within(at.x, 0) || !Within(at.y, 0)) {
      at = {std::clamp(at.x, 0.0, 1.0), std::clamp(at.y, 0.0, 1.0)};
      if (!state.Work()) return SolverStop::kWork;
      if (!(At(ray, patch, at.x, at.y).g < kDescentTolerancePx * kDescentTolerancePx))
        return SolverStop::kLeft;
    }
    state.AddRoot({patch, at.x, at.y});
    return SolverStop::kRoot;
  }

  const SolverScene& scene_;
  const std::vector<SolverPiece> pieces_;
  std::vector<double> accuracies_;  // of each patch, pixels²
};

Result<std::unique_ptr<const Solver>> MakeGradient(const SolverScene& scene, std::uint64_t max_bytes,
                                                   const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = WholePatches(kName, scene, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<Gradient>(scene, std::move(pieces).value()));
}

}  // namespace

SolverInfo GradientInfo() {
  return {.name = kName,
          .title = "Gradient method",
          .source = "A. Sisojevs, 3D scene rendering, 2011, equations 1 to 4",
          .does =
              "It descends the squared distance from the ray on the screen along its gradient, from one "
              "preliminary value for each pixel or from random points of a patch.",
          .does_not =
              "It need not find the nearest root, is imprecise where the surface is steep, and runs out of "
              "steps near outlines and on long patches.",
          .unit = SolverUnit::kPatch,
          .starts = SolverStarts::kMap,
          .takes_map = true,
          .tolerance_px = kDescentTolerancePx,
          .make = MakeGradient};
}

}  // namespace facetless
