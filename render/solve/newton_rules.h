// The rules by which the Newton iterations of newton_cramer.h and martin.h move and stop. They are the same for both, so
// that the methods differ only in the equations that they solve.
//
//  1. An iterate is a point of one patch of a face. When a step leaves that patch, the iterate moves to the patch of the
//     face that has the new parameters, and so it moves over the whole surface, as on a NURBS surface that is evaluated as
//     a whole. If the face ends there, or the other patch is trimmed away, the iterate keeps its patch, with parameters
//     outside of [0,1]. It does not pass the seam of a closed surface.
//  2. A solve ends
//       kRoot      if the iterate is within the tolerance of the ray, inside its patch up to kRootBorder, and in front of
//                  the eye,
//       kNoRoot    if it is within the tolerance of the ray, but behind the eye,
//       kDiverged  if the residual grows, except after a start from the map, or is not a number,
//       kLeft      if the patch of the start is trimmed away, if the iterate is outside its patch by more than the length
//                  of the patch, or if it is within the tolerance of the ray, but outside its patch,
//       kSingular  if the Jacobian is singular at the start,
//       kSteps     after kMostNewtonSteps steps, or kMostNewtonStepsFromMap from the map,
//       kWork      if the ray has no work left. Each evaluation takes one unit.
//  3. A value of the map can be rough: one of the 256 values over a whole face may stand for many pixels. So the residual
//     may grow on the way from it, and more steps are allowed. The thesis states no rule.
//  4. At a singular Jacobian, (u,v) moves by a tenth of a random fraction of the way back to the start, as Martin et al.
//     (2000) do. The random numbers follow from the ray and the start.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/solve/ray_random.h"
#include "render/solve/solver.h"
#include "render/solve/solver_scene.h"

namespace facetless {

inline constexpr int kMostNewtonSteps = 7;
inline constexpr int kMostNewtonStepsFromMap = 20;
// The residual at which the iterations end. The root is then far more accurate than any picture shows.
inline constexpr double kNewtonTolerancePx = 1e-8;
// A determinant has no correct digits if it is below this share of the sum of the absolute products that form it.
inline constexpr double kNewtonSingular = 0x1p-48;

struct NewtonStep {
  double du = 0, dv = 0;  // in parameters of the patch
  double residual = 0;    // in any unit; it is compared with that of the iterate before
  bool near = false;      // the iterate is within the tolerance of the ray
  bool visible = true;    // the iterate is in front of the eye
  bool singular = false;  // the step is not defined
};

// An iterate on a face.
class FaceIterate {
 public:
  // Places the iterate. `u` and `v` are parameters of the face. Returns false if the patch there is trimmed away.
  FaceIterate(const SolverScene& scene, const SolverFace& face, double u, double v)
      : scene_(scene), face_(face) {
    i_ = PatchOf(u, face.columns);
    j_ = PatchOf(v, face.rows);
    u_ = u - i_;
    v_ = v - j_;
    patch_ = scene.PatchAt(face, i_, j_);
  }

  bool exists() const { return patch_ != kNoIndex; }
  std::uint32_t patch() const { return patch_; }
  // Parameters of the patch, and of the face.
  double u() const { return u_; }
  double v() const { return v_; }
  double face_u() const { return i_ + u_; }
  double face_v() const { return j_ + v_; }

  void Move(double du, double dv) {
    u_ += du;
    v_ += dv;
    if (Within(0)) return;
    const std::uint32_t i = PatchOf(i_ + u_, face_.columns), j = PatchOf(j_ + v_, face_.rows);
    const std::uint32_t patch = scene_.PatchAt(face_, i, j);
    if (patch == kNoIndex) return;
    u_ += double(i_) - double(i);
    v_ += double(j_) - double(j);
    i_ = i, j_ = j, patch_ = patch;
  }
  // Whether the iterate lies in its patch, or outside of it by no more than this.
  bool Within(double beyond) const {
    return u_ >= -beyond && u_ <= 1 + beyond && v_ >= -beyond && v_ <= 1 + beyond;
  }

 private:
  // The patch of a row of `count` patches that holds t, or the nearest one.
  static std::uint32_t PatchOf(double t, std::uint32_t count) {
    if (!(t > 0)) return 0;
    return t < count ? static_cast<std::uint32_t>(t) : count - 1;
  }

  const SolverScene& scene_;
  const SolverFace& face_;
  std::uint32_t i_ = 0, j_ = 0, patch_ = kNoIndex;
  double u_ = 0, v_ = 0;
};

// Iterates from the start. step_at(patch, u, v) returns a NewtonStep. Requires a start on a face.
template <typename StepAt>
void SolveByNewton(const SolverScene& scene, const SolverRay& ray, const SolverStart& start,
                   SolverState& state, const StepAt& step_at) {
  FaceIterate at(scene, scene.faces()[start.surface], start.u, start.v);
  ++state.counters.solves;
  if (!at.exists()) return state.End(SolverStop::kLeft);
  RayRandom random(ray, start);
  double before = INFINITY;
  const int most_steps = start.from_map ? kMostNewtonStepsFromMap : kMostNewtonSteps;
  for (int step = 0; step <= most_steps; ++step) {
    if (!state.Work()) return state.End(SolverStop::kWork);
    const NewtonStep next = step_at(at.patch(), at.u(), at.v());
    if (next.near) {
      if (!at.Within(kRootBorder)) return state.End(SolverStop::kLeft);
      if (!next.visible) return state.End(SolverStop::kNoRoot);
      state.AddRoot({at.patch(), at.u(), at.v()});
      return state.End(SolverStop::kRoot);
    }
    // The comparison also ends iterations whose residual is not a number.
    if (!(next.residual <= (start.from_map ? INFINITY : before))) return state.End(SolverStop::kDiverged);
    before = next.residual;
    ++state.counters.iterations;
    if (next.singular) {
      const double back_u = start.u - at.face_u(), back_v = start.v - at.face_v();
      if (back_u == 0 && back_v == 0) return state.End(SolverStop::kSingular);
      const double random_u = random.Next(), random_v = random.Next();
      at.Move(0.1 * random_u * back_u, 0.1 * random_v * back_v);
      before = INFINITY;
      continue;
    }
    at.Move(next.du, next.dv);
    // An iterate may be outside by the length of a patch.
    if (!at.Within(1)) return state.End(SolverStop::kLeft);
  }
  state.End(SolverStop::kSteps);
}

}  // namespace facetless
