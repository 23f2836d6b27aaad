#include "render/compare/solved_surfaces.h"

#include <algorithm>
#include <utility>

namespace facetless {

std::vector<RepresentationFact> SolvedSurfaces::facts() const {
  return {{"tolerance_px", info_.tolerance_px}};
}

Result<TracedView> SolvedSurfaces::Trace(const Camera& camera, const TraceRequest& request,
                                         const Execution& execution) const {
  if (request.audit)
    return Error{ErrorCode::kBadUsage, "audit: the method " + info_.name +
                                           " cannot count all crossings of a ray; use certified or fast"};
  Result<SolverTrace> traced = TraceWithSolver(
      scene_, camera, info_, options_,
      {.execution = execution, .uv = request.uv, .leave_out = request.leave_out, .refine = request.refine});
  if (!traced.ok()) return traced.error();
  SolverStats& stats = traced.value().stats;
  TracedView view;
  view.frame = traced.value().frame;
  view.samples = std::move(traced.value().samples);
  // There is no bound for the depths.
  if (request.depth_error) {
    view.samples.depth_error.resize(view.samples.size());
    std::transform(view.samples.face.begin(), view.samples.face.end(), view.samples.depth_error.begin(),
                   [](std::uint32_t face) { return face == kNoIndex ? 0.0f : INFINITY; });
  }
  view.refinement = std::move(traced.value().refinement);
  view.counters = {stats.prepare_ms, stats.trace_ms, stats.rays, stats.hits, stats.refine_ms};
  view.structure_bytes = stats.bytes;
  DirectStats direct;
  direct.prepare_ms = stats.prepare_ms;
  direct.trace_ms = stats.trace_ms;
  direct.refine_ms = stats.refine_ms;
  direct.rays = stats.rays;
  direct.hits = stats.hits;
  direct.candidates = stats.candidates;
  direct.solves = stats.counters.solves;
  direct.iterations = stats.counters.iterations;
  direct.trim_tests = stats.trim_tests;
  direct.unresolved = stats.unresolved;
  direct.converged = stats.rays - stats.unresolved;
  direct.scene_bytes = view.structure_bytes;
  direct.isa = "scalar";
  view.direct = std::move(direct);
  view.solver = std::move(stats);
  return view;
}

Result<std::unique_ptr<SecondaryRays>> SolvedSurfaces::MakeRays(const SecondaryRaysRequest& request,
                                                                const Execution& execution) const {
  DirectOptions direct;
  direct.accuracy.max_bytes = options_.max_bytes;
  return ExactSurfaces(scene_, direct).MakeRays(request, execution);
}

Method MethodOfSolver(const SolverInfo& info) {
  return {.name = info.name,
          .title = info.title,
          .help = info.does,
          .source = info.source,
          .does_not = info.does_not,
          .solver = &info,
          .make = [&info](const MethodInput& input, double) -> Result<std::unique_ptr<const Representation>> {
            if (!input.direct.sections.empty())
              return Error{ErrorCode::kBadUsage,
                           "section: the method " + info.name +
                               " cannot cut a model; use certified or fast, or leave out section"};
            SolverOptions options = input.solver;
            options.max_bytes = input.max_bytes;
            return std::unique_ptr<const Representation>(std::make_unique<SolvedSurfaces>(
                input.scene, info, std::move(options), input.name, input.title));
          }};
}

}  // namespace facetless
