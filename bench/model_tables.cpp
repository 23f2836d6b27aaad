#include "bench/model_tables.h"

#include <algorithm>
#include <string>

#include "render/compare/report.h"
#include "render/kernels/tile_kernel.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

}  // namespace

Table CostTable(const std::vector<Json>& details) {
  Table table;
  table.title = "Where the time goes, one thread";
  table.columns = {"file",      "view", "conversion", "trimming",  "preparation", "tracing", "shading",
                   "mesh 1e-3", "tree", "tracing",    "mesh 1e-5", "tree",        "tracing"};
  const auto ms = [](const Json& image, const char* name) {
    return image.contains(name) ? MillisecondsText(image.at(name).get<double>()) : std::string("-");
  };
  for (const Json& view : details) {
    const Json& one = view.at("threads").at("1");
    const Json& direct = one.at("direct");
    const Json coarse = one.value("mesh_1e-3", Json::object()), fine = one.value("mesh_1e-5", Json::object());
    table.rows.push_back({view.at("file"), view.at("view"), ms(view, "convert_ms"), ms(direct, "scene_ms"),
                          ms(direct, "prepare_ms"), ms(direct, "trace_ms"), ms(direct, "shade_ms"),
                          ms(coarse, "mesh_ms"), ms(coarse, "build_ms"), ms(coarse, "trace_ms"),
                          ms(fine, "mesh_ms"), ms(fine, "build_ms"), ms(fine, "trace_ms")});
  }
  table.notes = {
      "The column \"conversion\" is the time from CAD faces to Bézier patches in the importer's process. No "
      "row includes it, and neither side pays for reading the file."};
  return table;
}

Table CounterTable(const std::vector<Json>& details) {
  Table table;
  table.title = "What was counted";
  table.columns = {"file",
                   "view",
                   "leaves",
                   "without a proof",
                   "candidates per packet",
                   "solves per ray",
                   "steps per solve",
                   "solves that a pixel shows",
                   "fallbacks per ray",
                   "trim tests per ray",
                   "like OpenCASCADE"};
  for (const Json& view : details) {
    const Json& counters = view.at("threads").at("1").at("counters");
    const auto number = [&](const char* name, double factor) {
      return counters.at(name).is_number() ? ThreeDigits(factor * counters.at(name).get<double>())
                                           : std::string("-");
    };
    std::string alike = "-";
    if (view.contains("exact_intersector")) {
      const Json& exact = view.at("exact_intersector");
      alike = exact.at("same").dump() + " of " + exact.at("rays").dump();
    }
    table.rows.push_back(
        {view.at("file"), view.at("view"), counters.at("leaves").dump(), counters.at("hard_leaves").dump(),
         ThreeDigits(kPacketLanes * counters.at("candidates").get<double>() /
                     counters.at("rays").get<double>()),
         number("solves_per_ray", 1), number("iterations_per_solve", 1), number("useful_solves", 100) + " %",
         number("fallbacks_per_ray", 1), number("trim_tests_per_ray", 1), alike});
  }
  table.notes = {"Packets are of " + std::to_string(kPacketWidth) + " × " + std::to_string(kPacketHeight) +
                 " rays."};
  return table;
}

Json CountersJson(const DirectStats& stats) {
  const auto per_ray = [&](std::uint64_t count) {
    return stats.rays > 0 ? static_cast<double>(count) / static_cast<double>(stats.rays) : 0;
  };
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return whole > 0 ? Json(static_cast<double>(part) / static_cast<double>(whole)) : Json(nullptr);
  };
  Json counters = TraceCountersJson(stats);
  counters.update(
      {{"bmssm_bits", stats.bmssm_bits},
       {"bmssm_bytes", stats.bmssm_bytes},
       {"scene_bytes", stats.scene_bytes},
       {"solves_per_ray", per_ray(stats.solves)},
       {"iterations_per_solve", share(stats.iterations, stats.solves)},
       // Solves whose root a pixel shows; fallbacks are none, so this is at most what the solver found.
       {"useful_solves", share(std::min(stats.hits, stats.solves), stats.solves)},
       {"fallbacks_per_ray", per_ray(stats.fallbacks)},
       {"trim_tests_per_ray", per_ray(stats.trim_tests)}});
  return counters;
}

}  // namespace facetless
