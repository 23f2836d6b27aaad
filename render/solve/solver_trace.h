// Traces a view of exact surfaces with a named solver (render/solve/solver.h) instead of the certified kernels, so that
// methods can be compared.
//
//     Result<SolverTrace> traced = TraceWithSolver(scene, camera, *FindSolver("martin"), {.structure = "bvh"}, {});
//     if (!traced) return traced.error();
//     const SampleBuffer& samples = traced.value().samples;
//
//  1. For each ray, the solver looks for roots in the pieces that an acceleration structure finds, from front to back, or
//     from the value of the map of preliminary values. Roots outside the trimmed face are dropped, and the nearest of the
//     others is the hit. Of hits at equal depths, that of the placed face with the lower number counts.
//  2. Faces are trimmed by their p-curves alone. They are not joined at their edges, as the certified tracer joins them:
//     where the file leaves gaps between faces, rays pass through.
//  3. Nothing is proven: a sample is *unresolved* if the work limit of its ray (solver.h, law 4) ended a solve, and
//     otherwise *converged*, which does not say that it is right.
//  4. The samples are the same for any number of threads. Another structure may change a sample within the tolerance of
//     the method, where the method loses roots that depend on the order of its solves, or where a ray runs out of work.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/base/execution.h"
#include "render/solve/solver_terms.h"
#include "render/trace/direct.h"
#include "render/view/camera.h"
#include "render/view/refinement.h"
#include "render/view/samples.h"

namespace facetless {

struct SolverInfo;  // render/solve/solver.h

// The structure that finds pieces if none is named.
inline constexpr const char* kUsualSolverStructure = "bvh";

struct SolverOptions {
  std::optional<SolverStarts> starts = {};        // nothing: the usual ones of the solver
  std::string structure = kUsualSolverStructure;  // a name of StructureNames(); not used with a map
  // The limit of memory for the surfaces, the solver, the map and the structure, which is measured once it is built.
  std::uint64_t max_bytes = std::uint64_t{4} << 30;
};

struct SolverTraceRequest {
  Execution execution = {};
  bool uv = false;  // fill samples.uv
  // Indexed by placed face: rays ignore the faces that are set. Null: no face is ignored.
  const std::vector<bool>* leave_out = nullptr;
  const RefineRequest* refine = nullptr;  // which pixels are traced again with several samples; null: none
};

struct SolverStats {
  std::string name, structure;  // of the solver; of the structure, empty with a map
  SolverStarts starts = SolverStarts::kPieces;
  double prepare_ms = 0, trace_ms = 0, refine_ms = 0;
  std::uint64_t rays = 0, hits = 0, unresolved = 0;
  std::uint64_t pieces = 0;      // that the structure finds; 0 with a map
  std::uint64_t candidates = 0;  // pieces that rays met, or values of the map
  std::uint64_t trim_tests = 0;
  std::uint64_t no_start = 0;  // rays without a value in the map
  std::uint64_t bytes = 0;     // of the surfaces, the solver, the structure, the map and the scene
  SolverCounters counters;
};

struct SolverTrace {
  CameraFrame frame;
  SampleBuffer samples;
  SolverStats stats;  // of the pixel centres
  // With a map: the placed face at which the search of each sample began; kNoIndex: it had no start. Else empty.
  PerSample<std::uint32_t> start_face;
  std::optional<Refinement> refinement;  // if one was requested
};

// Traces a view. Errors: kBadUsage (the camera; no structure has the name; the solver does not claim a surface, or does not
// start at a map; a published map cannot number the surfaces), kLimitExceeded (options.max_bytes), kCancelled.
Result<SolverTrace> TraceWithSolver(const Scene& scene, const Camera& camera, const SolverInfo& info,
                                    const SolverOptions& options, const SolverTraceRequest& request);

}  // namespace facetless
