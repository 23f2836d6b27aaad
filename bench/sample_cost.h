// What more than one sample per pixel costs: the whole picture of the same prepared surfaces, sampled in
// different ways, which take turns.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/compare/compare_view.h"

namespace facetless {

struct SampleCost {
  const char* name = "";         // "one", "uniform", "default"
  int samples = 1;               // per pixel; with "default" only where something happens within a pixel
  bool uniform = false;          // ViewOptions::uniform_samples
  std::vector<double> total_ms;  // View::total_ms of each turn
};

struct SampleTurns {
  int samples = 4;  // of "uniform" and "default"
  int repeats = 5;
};

// Measures all ways, after a warm-up of each. The first way is "one" and the last is "default". Errors: the
// errors of RenderView.
Result<std::vector<SampleCost>> MeasureSampleCosts(const Model& model, const Camera& camera,
                                                   const ViewOptions& options, const SampleTurns& turns);

// Returns an entry for each way: its median, and the median ratio to "one".
nlohmann::json SampleCostsJson(const std::vector<SampleCost>& costs);

// Returns a table of these entries for each file and view, from ModelCosts::details, for one thread.
Table SampleTable(const std::vector<nlohmann::json>& details);

}  // namespace facetless
