#include "tests/verify/extremes/methods.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/compare/hit_errors.h"
#include "render/solve/solver.h"
#include "render/solve/solver_trace.h"
#include "tests/verify/oracle/oracle.h"
#include "tests/verify/oracle/view_ray.h"

namespace facetless::extremes {
namespace {

// The memory limit of a picture, as for the precisions.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
// Single precision promises depths to about 1e-6 of the size of the model, which is a thousandth of a pixel of its picture.
constexpr double kFastTolerancePx = 1e-3;
// Rays that meet a surface at a smaller cosine than this see its depth change by more than ten pixels within one.
constexpr double kGrazing = 0.1;
constexpr const char* kFast = "fast";

// The same view with fewer pixels, and as square ones.
Camera Smaller(Camera camera, int size) {
  const int longer = std::max(camera.width_px, camera.height_px);
  if (longer <= size) return camera;
  const auto scaled = [&](int pixels) {
    const int few = std::max(1, pixels * size / longer);
    return few > 1 && few % 2 != pixels % 2 ? few - 1 : few;
  };
  camera.width_px = scaled(camera.width_px);
  camera.height_px = scaled(camera.height_px);
  return camera;
}

// The crossings of a ray at which `certified` is in doubt.
struct Doubt {
  std::size_t sample = 0;
  std::vector<oracle::Crossing> crossings;
};

class MeasuringMethods {
 public:
  MeasuringMethods(const Extreme& extreme, const MethodMeasureOptions& options)
      : extreme_(extreme), options_(options), model_(extreme.model()) {}

  MethodMeasurement Run() {
    if (const Result<void> valid = Validate(model_); !valid.ok()) {
      result_.error = valid.error();
      return result_;
    }
    for (const std::string& name : MethodNames())
      if (options_.methods.empty() ||
          std::find(options_.methods.begin(), options_.methods.end(), name) != options_.methods.end()) {
        result_.outcomes.emplace_back();
        result_.outcomes.back().method = name;
      }
    const Scene scene(model_);
    const oracle::Oracle surfaces(model_);
    for (const Camera& camera : extreme_.cameras(model_))
      if (!Render(scene, surfaces, Smaller(camera, options_.size))) break;
    return result_;
  }

 private:
  // Returns false if the view cannot be rendered.
  bool Render(const Scene& scene, const oracle::Oracle& surfaces, const Camera& camera) {
    DirectOptions options;
    options.accuracy.precision = Precision::kCertified;
    options.accuracy.max_bytes = kMostBytes;
    options.depth_error = true;
    Result<DirectResult> certified = TraceDirect(scene, camera, options);
    if (!certified.ok()) {
      result_.error = certified.error();
      return false;
    }
    const SampleBuffer& exact = certified.value().samples;
    result_.samples += exact.size();
    const std::vector<Doubt> doubts = Doubts(surfaces, camera, exact);
    for (MethodOutcome& outcome : result_.outcomes) {
      if (outcome.error) continue;
      const auto begin = std::chrono::steady_clock::now();
      const Result<SampleBuffer> samples = Trace(scene, camera, outcome.method);
      outcome.milliseconds +=
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
      if (!samples.ok()) {
        outcome.error = samples.error();
        continue;
      }
      AddErrors(certified.value(), samples.value(), &outcome);
      for (const Doubt& doubt : doubts) AddDoubt(camera, samples.value(), doubt, &outcome);
    }
    return true;
  }

  static Result<SampleBuffer> Trace(const Scene& scene, const Camera& camera, const std::string& method) {
    if (method == kFast) {
      DirectOptions options;
      options.accuracy.precision = Precision::kFast;
      options.accuracy.max_bytes = kMostBytes;
      Result<DirectResult> fast = TraceDirect(scene, camera, options);
      if (!fast.ok()) return fast.error();
      return std::move(fast.value().samples);
    }
    SolverOptions options;
    options.max_bytes = kMostBytes;
    Result<SolverTrace> solved = TraceWithSolver(scene, camera, *FindSolver(method), options, {});
    if (!solved.ok()) return solved.error();
    return std::move(solved.value().samples);
  }

  // Asks the oracle for the crossings at some of the samples without a proof, evenly among them.
  std::vector<Doubt> Doubts(const oracle::Oracle& surfaces, const Camera& camera, const SampleBuffer& exact) {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < exact.size(); ++i)
      if (exact.certificate[i] != Certificate::kCertified) open.push_back(i);
    const oracle::View view = ViewOf(camera);
    const double near = view.perspective ? 1e-9 * model_.Diagonal() : -INFINITY;
    std::vector<Doubt> doubts;
    const std::size_t count = std::min(open.size(), kJudgedDoubts);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = open[(2 * k + 1) * open.size() / (2 * count)];
      const int column = static_cast<int>(i) % exact.width, row = static_cast<int>(i) / exact.width;
      doubts.push_back({i, surfaces.Crossings(ViewPixelRay(view, column + 0.5, row + 0.5), near)});
    }
    result_.doubts += open.size();
    result_.judged_doubts += count;
    return doubts;
  }

  static oracle::View ViewOf(const Camera& camera) {
    return {camera.eye,    camera.target,    camera.up,       camera.projection == Projection::kPerspective,
            camera.height, camera.fov_y_deg, camera.width_px, camera.height_px};
  }

  static void AddErrors(const DirectResult& certified, const SampleBuffer& samples, MethodOutcome* outcome) {
    const SolverInfo* solver = FindSolver(outcome->method);
    const HitErrors errors = JudgeHits({certified.samples, certified.frame}, samples,
                                       solver == nullptr ? kFastTolerancePx : solver->tolerance_px);
    outcome->lost += errors.count(HitError::kLost);
    outcome->invented += errors.count(HitError::kInvented);
    outcome->imprecise += errors.count(HitError::kImprecise);
    outcome->open += errors.count(HitError::kUnresolved);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const bool hit = samples.face[i] != kNoIndex;
      const auto& n = samples.normal[i];
      const bool numbers = std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]) &&
                           (hit ? std::isfinite(samples.depth[i]) : samples.depth[i] == INFINITY);
      outcome->not_numbers += !numbers;
    }
  }

  void AddDoubt(const Camera& camera, const SampleBuffer& samples, const Doubt& doubt,
                MethodOutcome* outcome) const {
    if (!samples.certificate.empty() && samples.certificate[doubt.sample] == Certificate::kUnresolved) {
      ++outcome->open;
      return;
    }
    const bool hit = samples.face[doubt.sample] != kNoIndex;
    const double depth = samples.depth[doubt.sample], pixel = PixelMm(camera, depth);
    bool matched = !hit, near = !hit, nearer = false;
    for (const oracle::Crossing& crossing : doubt.crossings) {
      const double off = static_cast<double>(crossing.depth) - depth;
      // A doubt of the oracle reaches as far as its box, and a crossing that the ray grazes as far as a pixel shows.
      const double exact = kDoubtShare * model_.Diagonal() + static_cast<double>(crossing.half_depth) +
                           (crossing.proven ? 0 : pixel);
      const double same = std::max(exact, kOtherRootPx * pixel / std::max(crossing.cosine, kGrazing));
      if (crossing.standing != oracle::Standing::kOutside) {
        matched = matched || std::fabs(off) <= exact;
        near = near || std::fabs(off) <= same;
      }
      nearer = nearer ||
               (crossing.proven && crossing.standing == oracle::Standing::kInside && (!hit || off < -same));
    }
    outcome->lost += nearer;
    outcome->invented += !nearer && !near;
    outcome->imprecise += !nearer && near && !matched;
  }

  static double PixelMm(const Camera& camera, double depth) {
    if (camera.projection == Projection::kOrthographic) return camera.height / camera.height_px;
    const double half = camera.fov_y_deg / 2 * (3.14159265358979323846 / 180);
    return std::isfinite(depth) ? 2 * depth * std::tan(half) / camera.height_px : 0;
  }

  const Extreme& extreme_;
  const MethodMeasureOptions& options_;
  const Model model_;
  MethodMeasurement result_;
};

}  // namespace

std::vector<std::string> MethodNames() {
  std::vector<std::string> names = {kFast};
  for (const SolverInfo* info : Solvers()) names.push_back(info->name);
  return names;
}

MethodMeasurement MeasureMethods(const Extreme& extreme, const MethodMeasureOptions& options) {
  return MeasuringMethods(extreme, options).Run();
}

}  // namespace facetless::extremes
