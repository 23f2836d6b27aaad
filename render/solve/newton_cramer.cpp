#include "render/solve/newton_cramer.h"

#include <cmath>
#include <utility>

#include "render/solve/flattening.h"
#include "render/solve/newton_rules.h"
#include "render/solve/patch_jet.h"

namespace facetless {
namespace {

class NewtonCramer final : public Solver {
 public:
  NewtonCramer(const SolverScene& scene, std::vector<SolverPiece> pieces)
      : scene_(scene), pieces_(std::move(pieces)) {}

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece); }

  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    SolveByNewton(scene_, ray, start, state,
                  [&](std::uint32_t patch, double u, double v) { return StepAt(ray, patch, u, v); });
  }

 private:
  NewtonStep StepAt(const SolverRay& ray, std::uint32_t index, double u, double v) const {
    const SolverPatch& patch = scene_.patches()[index];
    const PatchJet<3> jet = EvaluatePatch<3>(&scene_.screen(patch)->x, patch.degree_u, patch.degree_v, u, v);
    // Equations 12 and 13 need three determinants. They share the minors of S and Sv, and of S and Su.
    const auto& [sx, sy, sw] = jet.value;
    const auto& [ux, uy, uw] = jet.du;
    const auto& [vx, vy, vw] = jet.dv;
    const double v_yw = sy * vw - sw * vy, v_xw = sx * vw - sw * vx, v_xy = sx * vy - sy * vx;
    const double u_yw = sy * uw - sw * uy, u_xw = sx * uw - sw * ux, u_xy = sx * uy - sy * ux;
    const double m = -(ux * v_yw - uy * v_xw + uw * v_xy);
    const double m_u = -(ray.x * v_yw - ray.y * v_xw + v_xy);
    const double m_v = ray.x * u_yw - ray.y * u_xw + u_xy;
    const double off_x = sx / sw - ray.x, off_y = sy / sw - ray.y;
    NewtonStep step;
    step.residual = off_x * off_x + off_y * off_y;
    step.near = step.residual < kNewtonTolerancePx * kNewtonTolerancePx;
    step.visible = sw > 0;
    step.singular = !(std::fabs(m) >
                      kNewtonSingular * (std::fabs(ux * v_yw) + std::fabs(uy * v_xw) + std::fabs(uw * v_xy)));
    step.du = sw / m * m_u;
    step.dv = sw / m * m_v;
    return step;
  }

  const SolverScene& scene_;
  const std::vector<SolverPiece> pieces_;
};

Result<std::unique_ptr<const Solver>> MakeNewtonCramer(const SolverScene& scene, std::uint64_t max_bytes,
                                                       const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = FlattenedPieces(scene, SolverUnit::kFace, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<NewtonCramer>(scene, std::move(pieces).value()));
}

}  // namespace

SolverInfo NewtonCramerInfo() {
  return {
      .name = "newton-cramer",
      .title = "Newton–Cramer",
      .source = "A. Sisojevs, 3D scene rendering, 2011, equations 10 to 13",
      .does =
          "It iterates by Newton's method with Cramer's rule on surfaces that are projected once, from one "
          "preliminary value for each pixel, or from the middle of nearly flat pieces.",
      .does_not =
          "It finds at most one root for each start, which need not be the nearest, and may lose roots near "
          "outlines and seams.",
      .unit = SolverUnit::kFace,
      .starts = SolverStarts::kMap,
      .takes_map = true,
      .tolerance_px = kNewtonTolerancePx,
      .make = MakeNewtonCramer};
}

}  // namespace facetless
