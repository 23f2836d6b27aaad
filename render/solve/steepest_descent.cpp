#include "render/solve/steepest_descent.h"

#include <cmath>
#include <utility>

#include "render/solve/face_spline.h"
#include "render/solve/gradient.h"
#include "render/solve/screen_distance.h"
#include "render/solve/whole_patches.h"

namespace facetless {
namespace {

constexpr const char* kName = "steepest-descent";

// The inverse of the golden ratio.
constexpr double kGoldenCut = 0.6180339887498949;

class SteepestDescent final : public Solver {
 public:
  SteepestDescent(const SolverScene& scene, std::vector<SolverPiece> pieces) : pieces_(std::move(pieces)) {
    splines_.reserve(scene.faces().size());
    for (const SolverFace& face : scene.faces()) splines_.emplace_back(scene, face);
  }

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override {
    std::uint64_t bytes = pieces_.size() * sizeof(SolverPiece);
    for (const FaceSpline& spline : splines_) bytes += sizeof spline + spline.bytes();
    return bytes;
  }

  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    ++state.counters.solves;
    state.End(Descend(ray, splines_[start.surface], start, state));
  }

 private:
  static SolverStop Descend(const SolverRay& ray, const FaceSpline& spline, const SolverStart& start,
                            SolverState& state) {
    constexpr double kTolerance = kDescentTolerancePx * kDescentTolerancePx;
    FaceSpline::Place at;
    if (!spline.Locate(spline.S(start.u), spline.T(start.v), &at)) return SolverStop::kLeft;
    ScreenDistance here;
    double best = INFINITY, shrunk = 1;
    // Whether the point moved since step 1 was done for it, and why the last step was refused.
    bool moved = true, refused_outside = false;
    for (int step = 0; step <= kMostDescentSteps;) {
      // Step 1. At the same point, it would compute the same again.
      if (moved) {
        if (!state.Work()) return SolverStop::kWork;
        here = DistanceFrom(ray, spline.Jet(at));
        shrunk = 1;
        moved = false;
      }
      if (step == 0) {
        if (here.g == INFINITY) return SolverStop::kLeft;
        if (here.g < kTolerance) return Finish(spline, at, state);
        best = here.g;
      }
      const double weight = 0.5 * shrunk / here.speed2;
      const double step_s = -weight * here.du, step_t = -weight * here.dv;
      // The second rule for stopping. The comparison also refuses steps that are not numbers.
      if (!(std::fabs(step_s) > kResolution || std::fabs(step_t) > kResolution))
        return refused_outside ? SolverStop::kLeft : SolverStop::kDiverged;
      while (step <= kMostDescentSteps) {
        // Step 2, and equation 9.
        FaceSpline::Place next;
        bool inside = false;
        const bool exists = spline.Locate(at.s + step_s, at.t + step_t, &next, &inside);
        if (inside && !exists) return SolverStop::kLeft;
        ++step;
        refused_outside = !inside;
        if (!inside) break;
        if (!state.Work()) return SolverStop::kWork;
        ++state.counters.iterations;
        const double g = DistanceFrom(ray, spline.Value(next)).g;
        // Step 3.
        if (!(g < best)) break;
        at = next;
        best = g;
        moved = true;
        if (g < kTolerance) return Finish(spline, at, state);
      }
      // Step 4.
      shrunk *= kGoldenCut;
    }
    return SolverStop::kSteps;
  }

  static SolverStop Finish(const FaceSpline& spline, const FaceSpline::Place& at, SolverState& state) {
    state.AddRoot(spline.Root(at));
    return SolverStop::kRoot;
  }

  const std::vector<SolverPiece> pieces_;
  std::vector<FaceSpline> splines_;  // of each face
};

Result<std::unique_ptr<const Solver>> MakeSteepestDescent(const SolverScene& scene, std::uint64_t max_bytes,
                                                          const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces =
      WholePatches(kName, scene, max_bytes, execution, SolverUnit::kFace);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<SteepestDescent>(scene, std::move(pieces).value()));
}

}  // namespace

SolverInfo SteepestDescentInfo() {
  return {
      .name = kName,
      .title = "Steepest descent",
      .source = "A. Sisojevs, 3D scene rendering, 2011, equations 7 to 9",
      .does =
          "It descends the squared distance from the ray on a B-spline as a whole, and keeps a direction "
          "while the distance falls, from one preliminary value for each pixel or from the middle of each "
          "patch.",
      .does_not =
          "It need not find the nearest root, stops in minima that are no roots, and is imprecise where the "
          "surface is steep.",
      .unit = SolverUnit::kFace,
      .starts = SolverStarts::kMap,
      .takes_map = true,
      .tolerance_px = kDescentTolerancePx,
      .make = MakeSteepestDescent};
}

}  // namespace facetless
