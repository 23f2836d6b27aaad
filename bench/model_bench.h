// Both tracers on one model: rows 1 to 8 of the aims.
//
//  1. Model and B-rep are in memory; reading the file is neither side's. From there each side pays for all
//     that its first image needs: the direct one for the scene (trimming), the leaves of the view, tracing
//     and shading; the mesh for meshing, the tree, tracing and shading. What the importer takes for the
//     conversion to Bézier patches is in ModelCosts, not in a row.
//  2. Both sides take turns after a warm-up of each, and the median counts. A mesh that takes longer than
//     kCheapMs is made once.
//  3. Images have one sample per pixel. Rates count every ray of the image, those that miss included.
//  4. Where the competitor sees something else than the direct renderer the times say nothing: hits of both
//     sides are kept and compared (ModelCosts::details).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/aims.h"
#include "render/base/execution.h"
#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"

namespace facetless {

inline constexpr double kDefaultDeflection = 1e-3, kFineDeflection = 1e-5;  // of the diagonal
// The rays that an exact intersector is asked, drawn from the image's pixels.
inline constexpr int kExactRays = 65536;

struct BenchMesh {
  std::shared_ptr<const Mesh> mesh;  // null: stopped at the limit
  double mesh_ms = 0;                // the mesher alone; at the limit, the limit
  double import_ms = 0;              // the whole process
  std::uint64_t mesher_peak_bytes = 0;
  std::string stopped;  // why there is no mesh
};

struct ExactAnswers {
  std::vector<double> depths;  // of the first rays that were asked; infinite for a miss
  double trace_ms = 0;         // of those
};

// How the bench gets what comes from the importer's process.
struct ImporterSide {
  // Tessellates within the time limit, on one thread: OpenCASCADE's own parallel mode gains nothing on these
  // parts. An error ends the bench; a limit is no error. Empty: there is no B-rep, and rows that need a mesh
  // are left out.
  std::function<Result<BenchMesh>(double deflection)> tessellate;
  // Asks OpenCASCADE's exact intersector, on one thread, for as many of the rays as the time limit allows.
  // Empty: row 5 is left out.
  std::function<Result<ExactAnswers>(const std::vector<Ray>& rays)> intersect;
};

struct BenchOptions {
  Execution execution;  // its threads are "all"
  int repeats = 5;
};

struct BenchCase {
  std::string file;
  const Model* model = nullptr;
  Camera camera;
};

// What the rows were computed from, for the JSON.
struct ModelCosts {
  std::vector<BenchValue> values;
  nlohmann::json
      details;  // of this file and view: times, triangles, counters, agreement with the exact intersector
};

// Errors: those of RenderView, and of the importer's side.
Result<ModelCosts> MeasureModel(const BenchCase& bench_case, const ImporterSide& importer,
                                const BenchOptions& options);

}  // namespace facetless
