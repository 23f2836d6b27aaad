#include "bench/growth.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bench/model_tables.h"
#include "bench/patch_scene.h"
#include "bench/statistics.h"
#include "render/base/parallel.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

Result<GrowthStep> MeasureStep(const Model& model, Camera camera, int size, int repeats) {
  camera.width_px = camera.height_px = size;
  DirectOptions options;
  options.execution.threads = 1;
  std::vector<GrowthStep> runs;
  for (int run = 0; run < repeats; ++run) {
    GrowthStep step;
    std::optional<Scene> scene;
    step.scene_ms = MeasureMilliseconds([&] { RunWithThreads(1, [&] { scene.emplace(model); }); });
    Result<DirectResult> traced = TraceDirect(*scene, camera, options);
    if (!traced) return traced.error();
    step.stats = std::move(traced.value().stats);
    step.prepare_ms = step.stats.prepare_ms;
    step.trace_ms = step.stats.trace_ms;
    step.size = size;
    step.faces = model.PlacedFaceCount();
    runs.push_back(std::move(step));
  }
  std::sort(runs.begin(), runs.end(),
            [](const GrowthStep& a, const GrowthStep& b) { return a.total() < b.total(); });
  return runs[runs.size() / 2];
}

double Exponent(const std::vector<GrowthStep>& steps, std::uint64_t DirectStats::*work) {
  std::vector<double> x, y;
  for (const GrowthStep& step : steps) {
    x.push_back(static_cast<double>(step.stats.*work));
    y.push_back(step.total());
  }
  return GrowthExponent(x, y);
}

Json StepsJson(const std::vector<GrowthStep>& steps) {
  Json json = Json::array();
  for (const GrowthStep& step : steps)
    json.push_back({{"label", step.label},
                    {"size", step.size},
                    {"faces", step.faces},
                    {"scene_ms", step.scene_ms},
                    {"prepare_ms", step.prepare_ms},
                    {"trace_ms", step.trace_ms},
                    {"total_ms", step.total()},
                    {"counters", CountersJson(step.stats)}});
  return json;
}

}  // namespace

Result<Growth> MeasureGrowth(const std::string& file, const Model& model, const Camera& camera,
                             const GrowthRange& range) {
  Growth growth;
  growth.file = file;
  growth.view = camera.name;
  for (const int size : range.sizes) {
    Result<GrowthStep> step = MeasureStep(model, camera, size, range.repeats);
    if (!step) return step.error();
    step.value().label = std::to_string(size) + "²";
    growth.pictures.push_back(std::move(step).value());
  }
  for (const int faces : range.faces) {
    const Model field = FieldOfFaces(faces);
    const Result<Camera> above =
        NamedView("iso", field.bounds, Projection::kOrthographic, range.scene_size, range.scene_size);
    if (!above) return above.error();
    Result<GrowthStep> step = MeasureStep(field, above.value(), range.scene_size, range.repeats);
    if (!step) return step.error();
    step.value().label = std::to_string(step.value().faces) + " faces";
    growth.scenes.push_back(std::move(step).value());
  }
  growth.picture_exponent = Exponent(growth.pictures, &DirectStats::rays);
  growth.scene_exponent = Exponent(growth.scenes, &DirectStats::leaves);
  return growth;
}

std::vector<BenchValue> GrowthValues(const Growth& growth) {
  BenchValue picture;
  picture.aim = "growth_image";
  picture.file = growth.file;
  picture.view = growth.view;
  picture.direct = growth.pictures.back().total();
  picture.other = growth.pictures.front().total();
  picture.ratio = growth.picture_exponent;
  BenchValue scene = picture;
  scene.aim = "growth_faces";
  scene.file = "field of faces";
  scene.view = "iso";
  scene.direct = growth.scenes.back().total();
  scene.other = growth.scenes.front().total();
  scene.ratio = growth.scene_exponent;
  return {picture, scene};
}

Table GrowthTable(const Growth& growth) {
  Table table;
  table.title = "Growth, one thread";
  table.columns = {"",        "faces", "rays",           "leaves",       "trimming", "preparation",
                   "tracing", "total", "total per leaf", "total per ray"};
  for (const auto* steps : {&growth.pictures, &growth.scenes})
    for (const GrowthStep& step : *steps) {
      const auto nanoseconds = [&](std::uint64_t count) {
        return count > 0 ? ThreeDigits(1e6 * step.total() / static_cast<double>(count)) + " ns"
                         : std::string("-");
      };
      table.rows.push_back({step.label, std::to_string(step.faces), std::to_string(step.stats.rays),
                            std::to_string(step.stats.leaves), MillisecondsText(step.scene_ms),
                            MillisecondsText(step.prepare_ms), MillisecondsText(step.trace_ms),
                            MillisecondsText(step.total()), nanoseconds(step.stats.leaves),
                            nanoseconds(step.stats.rays)});
    }
  table.notes = {"The pictures are of " + growth.file + ", view " + growth.view +
                 ": time grows with the number of rays to the power " + ThreeDigits(growth.picture_exponent) +
                 ". The faces are generated, on " +
                 (growth.scenes.empty() ? "" : std::to_string(growth.scenes.front().size)) +
                 "² pixels: time grows with the number of leaves seen to the power " +
                 ThreeDigits(growth.scene_exponent) + "."};
  return table;
}

Json GrowthJson(const Growth& growth) {
  return {{"file", growth.file},
          {"view", growth.view},
          {"pictures", StepsJson(growth.pictures)},
          {"scenes", StepsJson(growth.scenes)},
          {"picture_exponent", growth.picture_exponent},
          {"scene_exponent", growth.scene_exponent}};
}

}  // namespace facetless
