// Measures both tracers on one model: rows 1 to 8 and 11 of the aims.
//
//  1. The model and the B-rep are in memory; the time of reading the file counts for neither side. Each side
//     then pays for everything that its first image needs: the direct renderer for the scene (trimming), the
//     leaves of the view, tracing and shading; the mesh for meshing, the tree, tracing and shading.
//     ModelCosts has the importer's time for the conversion to Bézier patches, which is in no row.
//  2. Both sides take turns after one warm-up each, and the median counts. A mesh that takes longer than
//     kCheapMs is made only once. The ratios of tracing, and those of samples, are medians of the ratios of each
//     turn.
//  3. Images have one sample per pixel, except in row 11. Rates count every ray of the image, including those that
//     miss.
//  4. If the competitor computes another image than the direct renderer, its time is meaningless. Therefore
//     the hits of both sides are kept and compared (ModelCosts::details).
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

inline constexpr double kDefaultDeflection = 1e-3, kFineDeflection = 1e-5;  // relative to the diagonal
// The number of rays that the exact intersector traces. They are drawn from the image's pixels.
inline constexpr int kExactRays = 65536;

struct BenchMesh {
  std::shared_ptr<const Mesh> mesh;  // null: the mesher was stopped at the limit
  double mesh_ms = 0;                // the mesher alone; if it was stopped, the limit
  double import_ms = 0;              // the whole importer process
  std::uint64_t mesher_peak_bytes = 0;
  std::string stopped;  // the reason if there is no mesh
};

struct ExactAnswers {
  std::vector<double> depths;  // depths of the first rays, as many as were answered; infinite for a miss
  double trace_ms = 0;         // time of these rays
};

// The results that the bench needs from the importer's process.
struct ImporterSide {
  // Tessellates within the time limit, on one thread, since OpenCASCADE's own parallel mode is no faster on
  // these parts. An error ends the bench; reaching the limit is no error. Empty: there is no B-rep, and rows
  // that need a mesh are left out.
  std::function<Result<BenchMesh>(double deflection)> tessellate;
  // Traces as many of the rays as the time limit allows with OpenCASCADE's exact intersector, on one thread.
  // Empty: row 5 is left out.
  std::function<Result<ExactAnswers>(const std::vector<Ray>& rays)> intersect;
};

struct BenchOptions {
  Execution execution;  // execution.threads is what "all threads" means
  int repeats = 5;
  int samples = 4;  // per pixel, in the pictures of row 11
};

struct BenchCase {
  std::string file;
  const Model* model = nullptr;
  Camera camera;
};

// The values of the rows, and the measurements behind them for the JSON.
struct ModelCosts {
  std::vector<BenchValue> values;
  nlohmann::json
      details;  // of this file and view: times, triangles, counters, agreement with the exact intersector
};

// Errors: those of RenderView, and those of the importer's side.
Result<ModelCosts> MeasureModel(const BenchCase& bench_case, const ImporterSide& importer,
                                const BenchOptions& options);

}  // namespace facetless
