#include "bench/sample_cost.h"

#include <string>

#include "bench/statistics.h"

namespace facetless {

using Json = nlohmann::json;

Result<std::vector<SampleCost>> MeasureSampleCosts(const Model& model, const Camera& camera,
                                                   const ViewOptions& options, const SampleTurns& turns) {
  std::vector<SampleCost> costs = {
      {"one", 1, false, {}}, {"uniform", turns.samples, true, {}}, {"default", turns.samples, false, {}}};
  const Scene scene(model);
  const ExactSurfaces surfaces(scene, {});
  for (int round = 0; round <= turns.repeats; ++round) {
    for (SampleCost& cost : costs) {
      ViewOptions sampled = options;
      sampled.samples = cost.samples;
      sampled.uniform_samples = cost.uniform;
      const Result<View> view = RenderView(surfaces, model, camera, sampled);
      if (!view) return view.error();
      if (round > 0) cost.total_ms.push_back(view.value().total_ms);
    }
  }
  return costs;
}

Json SampleCostsJson(const std::vector<SampleCost>& costs) {
  Json json = Json::array();
  for (const SampleCost& cost : costs)
    json.push_back({{"name", cost.name},
                    {"samples", cost.samples},
                    {"total_ms", Median(cost.total_ms)},
                    {"ratio_to_one", MedianRatio(cost.total_ms, costs.front().total_ms)}});
  return json;
}

Table SampleTable(const std::vector<Json>& details) {
  Table table;
  table.title = "Samples per pixel, one thread";
  table.columns = {"file", "view", "sampling", "samples per pixel", "whole picture", "times one sample"};
  for (const Json& view : details)
    for (const Json& cost : view.at("threads").at("1").at("samples"))
      table.rows.push_back({view.at("file"), view.at("view"), cost.at("name"), cost.at("samples").dump(),
                            MillisecondsText(cost.at("total_ms").get<double>()),
                            TimesText(cost.at("ratio_to_one").get<double>())});
  return table;
}

}  // namespace facetless
