#include "render/solve/martin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/solve/flattening.h"
#include "render/solve/newton_rules.h"
#include "render/solve/patch_jet.h"

namespace facetless {
namespace {

// Two planes whose intersection is the ray.
struct RayPlanes {
  explicit RayPlanes(const SolverRay& ray) {
    const Vec3 d = Normalized(ray.direction);
    // The first normal contains the direction's largest component, so that it does not vanish.
    const bool x_largest = std::fabs(d.x) > std::fabs(d.y) && std::fabs(d.x) > std::fabs(d.z);
    normal1 = Normalized(x_largest ? Vec3{d.y, -d.x, 0} : Vec3{0, d.z, -d.y});
    normal2 = Cross(normal1, d);
    offset1 = -Dot(normal1, ray.origin);
    offset2 = -Dot(normal2, ray.origin);
  }
  Vec3 normal1, normal2;
  double offset1 = 0, offset2 = 0;
};

class Martin final : public Solver {
 public:
  Martin(const SolverScene& scene, std::vector<SolverPiece> pieces)
      : scene_(scene),
        pieces_(std::move(pieces)),
        perspective_(scene.frame().projection == Projection::kPerspective),
        pixel_(std::min(scene.frame().pixel_x, scene.frame().pixel_y)) {}

  std::span<const SolverPiece> pieces() const override { return pieces_; }
  std::uint64_t bytes() const override { return pieces_.size() * sizeof(SolverPiece); }

  void Solve(const SolverRay& ray, const SolverStart& start, SolverState& state) const override {
    const RayPlanes planes(ray);
    // A distance e from the ray is at most e·|direction| in the plane of constant depth, in which pixels are measured.
    const double tolerance = kNewtonTolerancePx * pixel_ / Length(ray.direction);
    SolveByNewton(scene_, ray, start, state, [&](std::uint32_t patch, double u, double v) {
      return StepAt(ray, planes, tolerance, patch, u, v);
    });
  }

 private:
  NewtonStep StepAt(const SolverRay& ray, const RayPlanes& planes, double tolerance, std::uint32_t index,
                    double u, double v) const {
    const SolverPatch& patch = scene_.patches()[index];
    const PatchJet<4> jet = EvaluatePatch<4>(&scene_.space(patch)->x, patch.degree_u, patch.degree_v, u, v);
    // Apply the quotient rule.
    const double inverse = 1 / jet.value[3];
    const Vec3 s = inverse * Vec3{jet.value[0], jet.value[1], jet.value[2]};
    const Vec3 su = inverse * (Vec3{jet.du[0], jet.du[1], jet.du[2]} - jet.du[3] * s),
               sv = inverse * (Vec3{jet.dv[0], jet.dv[1], jet.dv[2]} - jet.dv[3] * s);
    const double f1 = Dot(planes.normal1, s) + planes.offset1, f2 = Dot(planes.normal2, s) + planes.offset2;
    const double a = Dot(planes.normal1, su), b = Dot(planes.normal1, sv), c = Dot(planes.normal2, su),
                 d = Dot(planes.normal2, sv);
    const double determinant = a * d - b * c;
    NewtonStep step;
    step.residual = f1 * f1 + f2 * f2;
    if (perspective_) {
      const double depth = Dot(s - ray.origin, scene_.frame().forward);
      step.visible = depth > 0;
      tolerance *= std::fabs(depth);
    }
    step.near = step.residual < tolerance * tolerance;
    step.singular = !(std::fabs(determinant) > kNewtonSingular * (std::fabs(a * d) + std::fabs(b * c)));
    step.du = -(d * f1 - b * f2) / determinant;
    step.dv = -(a * f2 - c * f1) / determinant;
    return step;
  }

  const SolverScene& scene_;
  const std::vector<SolverPiece> pieces_;
  const bool perspective_;
  const double pixel_;  // mm, the smaller side; at a depth of 1 mm in perspective views
};

Result<std::unique_ptr<const Solver>> MakeMartin(const SolverScene& scene, std::uint64_t max_bytes,
                                                 const Execution& execution) {
  Result<std::vector<SolverPiece>> pieces = FlattenedPieces(scene, SolverUnit::kFace, max_bytes, execution);
  if (!pieces.ok()) return pieces.error();
  return std::unique_ptr<const Solver>(std::make_unique<Martin>(scene, std::move(pieces).value()));
}

}  // namespace

SolverInfo MartinInfo() {
  return {.name = "martin",
          .title = "Martin et al.",
          .source =
              "W. Martin, E. Cohen, R. Fish, P. Shirley, Practical Ray Tracing of Trimmed NURBS Surfaces, "
              "2000",
          .does =
              "It iterates by Newton's method on two planes through the ray, from the middle of nearly flat "
              "pieces.",
          .does_not =
              "It finds at most one root in each piece, and loses roots where the residual grows on the "
              "way, mostly near outlines.",
          .unit = SolverUnit::kFace,
          .tolerance_px = kNewtonTolerancePx,
          .make = MakeMartin};
}

}  // namespace facetless
