// Rays that start on exact surfaces, in every structure, and against Embree alone on a mesh of the same file.
//
//     Result<SurfaceRayBench> bench = MeasureSurfaceRays({"part.step", &model, camera, &mesh}, {.repeats = 3}, execution);
//
//  1. The starts are hits of a view of the exact surfaces. Shadow rays go from them towards the key light, ambient rays
//     to all sides by the cosine and over a quarter of the model's diagonal. Primary rays come from outside, and random
//     rays begin and point anywhere within the bounds. Shadow and ambient rays ask whether anything blocks them, the
//     others for the nearest hit.
//  2. Everything is measured on one thread, with the starts exactly on the surface, trimmed and certified. Where a
//     structure is slow, it is asked fewer rays.
//  3. Embree gets its rays lifted and rounded beforehand, and asks one ray at a time, in packets of 8, and of 16; the
//     fastest counts. It takes turns with the usual structure, and ratios are medians of the ratios of each turn.
//  4. A mesh answers *wrongly* where the answer of the exact surfaces is certified, and Embree's answer to the lifted
//     ray is another one.
//  5. Every structure must give the same answers as the usual one: `unlike` counts rays that differ.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/structure_bench.h"
#include "bench/table.h"
#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/model/mesh.h"
#include "render/model/model.h"
#include "render/view/camera.h"

namespace facetless {

// What one kind of rays costs in one structure.
struct SurfaceRayCost {
  std::uint64_t rays = 0;
  double per_second = 0;
  double certified = 0;  // share of the rays
  std::uint64_t unlike = 0;
};

struct SurfaceRayRow {
  std::string name;
  double build_ms = 0;
  std::uint64_t bytes = 0;
  std::array<SurfaceRayCost, 4> kinds;  // by BenchRays
};

// Embree on the rays of one kind, and the usual structure against it.
struct SurfaceRayPeer {
  double per_second = 0;  // of the fastest width; 0: not measured
  int width = 0;
  double ratio = 0;  // the usual structure's rays per second over Embree's
  double wrong = 0;  // share of the rays (law 4)
};

struct SurfaceRayBench {
  std::string name;
  std::size_t starts = 0;
  double deflection = 0;                // of the mesh, relative; 0: there is none
  std::vector<SurfaceRayRow> rows;      // the usual structure first
  std::array<SurfaceRayPeer, 4> peers;  // shadow and ambient alone
};

struct SurfaceRayCase {
  std::string name;
  const Model* model = nullptr;
  Camera camera;
  const Mesh* mesh = nullptr;  // at `deflection`; null: Embree is not measured
  double deflection = 0;
};

// Errors: those of TraceDirect, ExactRays::Build and BaselineScene::Build; kNothingUsable (no ray hits the model).
Result<SurfaceRayBench> MeasureSurfaceRays(const SurfaceRayCase& subject,
                                           const StructureBenchSettings& settings,
                                           const Execution& execution);

Table SurfaceRayTable(const SurfaceRayBench& bench);
nlohmann::json SurfaceRayJson(const SurfaceRayBench& bench);
// The rays per second of all structures and kinds of rays, for each file, on a logarithmic scale, as SVG.
std::string SurfaceRayPlot(const std::vector<SurfaceRayBench>& benches);

}  // namespace facetless
