// SolvedSurfaces: the exact surfaces of a scene, traced with a named solver (render/solve/solver_trace.h). It is a
// representation like the certified one, so that pictures, differences and plots of methods can be made.
#pragma once

#include <memory>
#include <string>

#include "render/compare/method.h"
#include "render/compare/representation.h"
#include "render/solve/solver.h"
#include "render/solve/solver_trace.h"

namespace facetless {

// The scene must outlive the representation.
class SolvedSurfaces final : public Representation {
 public:
  SolvedSurfaces(const Scene& scene, const SolverInfo& info, SolverOptions options, std::string name,
                 std::string title)
      : scene_(scene),
        info_(info),
        options_(std::move(options)),
        name_(std::move(name)),
        title_(std::move(title)) {}

  std::string name() const override { return name_; }
  std::string title() const override { return title_; }
  const Scene* exact() const override { return &scene_; }
  std::vector<RepresentationFact> facts() const override;
  // The errors of TraceWithSolver; kBadUsage (an audit, which only the certified tracer can make).
  Result<TracedView> Trace(const Camera& camera, const TraceRequest& request,
                           const Execution& execution) const override;
  // The rays of light are those of ExactSurfaces, with their proofs, whatever the solver is: solvers trace views only.
  Result<std::unique_ptr<SecondaryRays>> MakeRays(const SecondaryRaysRequest& request,
                                                  const Execution& execution) const override;

 private:
  const Scene& scene_;
  const SolverInfo& info_;
  const SolverOptions options_;
  const std::string name_, title_;
};

// The method that traces with a solver. `info` must outlive it.
Method MethodOfSolver(const SolverInfo& info);

}  // namespace facetless
