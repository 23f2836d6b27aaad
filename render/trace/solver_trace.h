// Traces a view of exact surfaces with a solver by name (render/solve/solver.h) instead of the certified kernels, so that
// methods can be compared.
//
//     Result<SolverTrace> traced = TraceWithSolver(scene, camera, *FindSolver("martin"), {.structure = "bvh"});
//     if (!traced) return traced.error();
//     const SampleBuffer& samples = traced.value().samples;
//
//  1. A ray asks the solver for roots in the pieces that an acceleration structure finds, front to back, or at the value
//     of the map of preliminary values. Roots outside the trimmed face are dropped, and the nearest of the others is the
//     hit. At equal depths, the lower placed face decides.
//  2. Faces are trimmed by their p-curves alone. Neighbouring faces are not joined at their edges, as the certified
//     tracer joins them: where the file leaves gaps between faces, rays pass through.
//  3. Nothing is proven: samples are *converged*, or *unresolved* if the work limit of the ray ended a solve. A ray's work
//     is bounded (solver.h, law 4), and the bound is the only thing that a sample says about its certainty.
//  4. The samples are the same for any number of threads. Another structure may change them within the tolerance of the
//     method, or, if the method depends on the order of its solves, where the method loses roots.
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
  std::optional<SolverStarts> starts = {};           // nothing: the usual ones of the solver
  std::string structure = kUsualSolverStructure;     // a name of StructureNames(); not used with a map
  std::uint64_t max_bytes = std::uint64_t{4} << 30;  // of the surfaces, the pieces, the structure and the map
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

// Traces a view. Errors: kBadUsage (camera, no structure has the name, the solver does not claim a surface, or it does not
// start at a map, or a published map cannot number the surfaces), kLimitExceeded (options.max_bytes), kCancelled.
Result<SolverTrace> TraceWithSolver(const Scene& scene, const Camera& camera, const SolverInfo& info,
                                    const SolverOptions& options, const SolverTraceRequest& request);

}  // namespace facetless
