#include "render/solve/solver.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "render/solve/bezier_clipping.h"
#include "render/solve/coherent_newton.h"
#include "render/solve/gradient.h"
#include "render/solve/martin.h"
#include "render/solve/newton_cramer.h"
#include "render/solve/robust_clipping.h"
#include "render/solve/steepest_descent.h"

namespace facetless {
namespace {

std::vector<SolverInfo> BuiltIn() {
  return {NewtonCramerInfo(),   GradientInfo(),       SteepestDescentInfo(), MartinInfo(),
          BezierClippingInfo(), RobustClippingInfo(), CoherentNewtonInfo()};
}

// Pointers to the elements stay valid: solvers are never removed, and each is allocated on the heap.
std::vector<std::unique_ptr<const SolverInfo>>& Registry() {
  static std::vector<std::unique_ptr<const SolverInfo>> solvers = [] {
    std::vector<std::unique_ptr<const SolverInfo>> built_in;
    for (SolverInfo& info : BuiltIn())
      built_in.push_back(std::make_unique<const SolverInfo>(std::move(info)));
    return built_in;
  }();
  return solvers;
}

bool Claims(const SolverInfo& info, const SolverPatch& patch) {
  return patch.degree_u <= info.max_degree && patch.degree_v <= info.max_degree &&
         (info.rational || !patch.rational);
}

}  // namespace

void Solver::BeginRow(int, SolverState&) const {}

std::vector<const SolverInfo*> Solvers() {
  std::vector<const SolverInfo*> solvers;
  for (const auto& info : Registry()) solvers.push_back(info.get());
  return solvers;
}

const SolverInfo* FindSolver(std::string_view name) {
  for (const auto& info : Registry())
    if (info->name == name) return info.get();
  return nullptr;
}

Result<void> CheckClaims(const SolverInfo& info, const SolverScene& scene) {
  for (const SolverPatch& patch : scene.patches()) {
    if (Claims(info, patch)) continue;
    std::string others;
    for (const SolverInfo* other : Solvers())
      if (Claims(*other, patch)) others += (others.empty() ? "" : ", ") + other->name;
    const SolverFace& face = scene.faces()[patch.face];
    const std::string name = face.face == nullptr      ? std::to_string(face.placed_face)
                             : face.face->name.empty() ? face.face->entity
                                                       : face.face->name;
    return Error{ErrorCode::kBadUsage, "method: " + info.name + " does not take the surface of face " + name +
                                           ", which is " + (patch.rational ? "rational, " : "") +
                                           "of degree " + std::to_string(patch.degree_u) + "×" +
                                           std::to_string(patch.degree_v) + "; use certified" +
                                           (others.empty() ? "" : ", " + others)};
  }
  return {};
}

RegisterSolver::RegisterSolver(SolverInfo info) {
  const bool named = !info.name.empty() && std::all_of(info.name.begin(), info.name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  });
  if (!named || FindSolver(info.name) != nullptr || info.make == nullptr)
    throw std::invalid_argument(
        "the solver '" + info.name +
        "' cannot be registered: its name is taken or malformed, or it lacks a function");
  Registry().push_back(std::make_unique<const SolverInfo>(std::move(info)));
}

}  // namespace facetless
