// Methods by name on one view: what each costs, and what it gets wrong, judged by the certified image.
//
//     const Result<MethodReference> reference = MakeMethodReference(scene, camera, execution);
//     for (const MethodTrial& trial : MethodTrials(choices))
//       figures.push_back(MeasureMethod(scene, reference.value(), trial, options).value());
//     Print(TableText(MethodTable("part.step", figures), TableStyle::kText));
//
//  1. All times are those of one thread, for a view of one sample per pixel, without light. A method is run three times,
//     or until a run takes more than a second, and the median is reported.
//  2. A method that may start at the map of preliminary values is measured with the map of 8 bits, with the wide map, and
//     with the pieces that a structure finds.
//  3. A method that cannot trace the model is listed with the reason.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/base/execution.h"
#include "render/compare/hit_errors.h"
#include "render/compare/method.h"
#include "render/compare/representation.h"

namespace facetless {

struct MethodReference {
  Camera camera;
  TracedView view;  // certified, with depth errors
};
// Errors: those of TraceDirect.
Result<MethodReference> MakeMethodReference(const Scene& scene, const Camera& camera,
                                            const Execution& execution);

struct MethodTrial {
  MethodChoice choice;
  std::optional<SolverStarts> starts;  // nothing: the method has none
};
// Law 2.
std::vector<MethodTrial> MethodTrials(const std::vector<MethodChoice>& choices);

struct MethodFigures {
  MethodTrial trial;
  std::string missing;  // why there are no figures; empty if there are
  int repetitions = 0;
  double prepare_ms = 0, trace_ms = 0;
  std::uint64_t rays = 0, hits = 0, solves = 0, iterations = 0, bytes = 0;
  HitErrors errors;
  // With a map: of the samples at which the reference has a certified hit, those without a start, and those whose start
  // lies on another face. Nothing without a map.
  std::optional<std::uint64_t> no_start, wrong_start;
};

struct MethodBenchOptions {
  Execution execution;  // its threads are not used
  std::string structure = kUsualSolverStructure;
  std::uint64_t max_bytes = std::uint64_t{4} << 30;
};

// Errors: kCancelled.
Result<MethodFigures> MeasureMethod(const Scene& scene, const MethodReference& reference,
                                    const MethodTrial& trial, const MethodBenchOptions& options);

// The name of a trial: "newton-cramer, map", "martin".
std::string MethodTrialName(const MethodTrial& trial);
// The same for the names of files: "newton-cramer-map".
std::string MethodTrialStem(const MethodTrial& trial);

Table MethodTable(const std::string& title, const std::vector<MethodFigures>& figures);
nlohmann::json MethodFiguresJson(const MethodFigures& figures);

}  // namespace facetless
