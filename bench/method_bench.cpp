#include "bench/method_bench.h"

#include <algorithm>
#include <utility>

#include "bench/statistics.h"
#include "render/solve/solver.h"
#include "render/solve/solver_trace.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// Runs that take less are repeated.
constexpr double kQuickMs = 1000;
constexpr int kRepetitions = 3;

// What a run of a method gives.
struct Run {
  TracedView view;
  PerSample<std::uint32_t> start_face;
};

Result<Run> Trace(const Scene& scene, const MethodReference& reference, const MethodTrial& trial,
                  const MethodBenchOptions& options) {
  const Method& method = *trial.choice.method;
  const Execution one = {1, options.execution.cancel};
  Run run;
  // A solver is traced without a representation between, for the starts of its samples.
  if (method.solver != nullptr) {
    Result<SolverTrace> traced = TraceWithSolver(
        scene, reference.camera, *method.solver,
        {.starts = trial.starts, .structure = options.structure, .max_bytes = options.max_bytes},
        {.execution = one});
    if (!traced.ok()) return traced.error();
    const SolverStats& stats = traced.value().stats;
    run.view.samples = std::move(traced.value().samples);
    run.view.counters = {stats.prepare_ms, stats.trace_ms, stats.rays, stats.hits};
    run.view.structure_bytes = stats.bytes;
    run.view.direct.emplace();
    run.view.direct->solves = stats.counters.solves;
    run.view.direct->iterations = stats.counters.iterations;
    run.start_face = std::move(traced.value().start_face);
    return run;
  }
  const DirectOptions direct;
  auto made = MakeRepresentation(
      trial.choice, {.scene = scene, .direct = direct, .execution = one, .max_bytes = options.max_bytes});
  if (!made.ok()) return made.error();
  Result<TracedView> view = made.value()->Trace(reference.camera, {}, one);
  if (!view.ok()) return view.error();
  run.view = std::move(view).value();
  return run;
}

// The precision of a method that is not a solver.
double ToleranceOf(const Method& method) {
  // Single precision promises depths to about 1e-6 of the model's size, which is a thousandth of a pixel.
  constexpr double kOther = 1e-3;
  return method.solver != nullptr ? method.solver->tolerance_px : kOther;
}

void CountStarts(const SampleBuffer& exact, const PerSample<std::uint32_t>& start_face,
                 MethodFigures* figures) {
  if (start_face.empty()) return;
  std::uint64_t none = 0, wrong = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (exact.face[i] == kNoIndex || exact.certificate[i] != Certificate::kCertified) continue;
    none += start_face[i] == kNoIndex;
    wrong += start_face[i] != kNoIndex && start_face[i] != exact.face[i];
  }
  figures->no_start = none;
  figures->wrong_start = wrong;
}

std::string CountOrDash(const std::optional<std::uint64_t>& count) {
  return count ? std::to_string(*count) : "-";
}

}  // namespace

Result<MethodReference> MakeMethodReference(const Scene& scene, const Camera& camera,
                                            const Execution& execution) {
  DirectOptions direct;
  direct.accuracy.precision = Precision::kCertified;
  Result<TracedView> view = ExactSurfaces(scene, direct).Trace(camera, {.depth_error = true}, execution);
  if (!view.ok()) return view.error();
  return MethodReference{camera, std::move(view).value()};
}

std::vector<MethodTrial> MethodTrials(const std::vector<MethodChoice>& choices) {
  std::vector<MethodTrial> trials;
  for (const MethodChoice& choice : choices) {
    const SolverInfo* solver = choice.method->solver;
    if (solver == nullptr) {
      trials.push_back({choice, std::nullopt});
      continue;
    }
    if (solver->takes_map)
      for (const SolverStarts starts : {SolverStarts::kPublishedMap, SolverStarts::kMap})
        trials.push_back({choice, starts});
    trials.push_back({choice, SolverStarts::kPieces});
  }
  return trials;
}

Result<MethodFigures> MeasureMethod(const Scene& scene, const MethodReference& reference,
                                    const MethodTrial& trial, const MethodBenchOptions& options) {
  MethodFigures figures;
  figures.trial = trial;
  std::vector<double> prepare, trace;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    Result<Run> run = Trace(scene, reference, trial, options);
    if (!run.ok()) {
      if (run.error().code == ErrorCode::kCancelled) return run.error();
      figures.missing = run.error().message;
      return figures;
    }
    const TracedView& view = run.value().view;
    prepare.push_back(view.counters.prepare_ms);
    trace.push_back(view.counters.trace_ms);
    ++figures.repetitions;
    if (repetition == 0) {
      figures.rays = view.counters.rays;
      figures.hits = view.counters.hits;
      figures.solves = view.direct ? view.direct->solves : 0;
      figures.iterations = view.direct ? view.direct->iterations : 0;
      figures.bytes = view.structure_bytes;
      figures.errors = JudgeHits({reference.view.samples, reference.view.frame}, view.samples,
                                 ToleranceOf(*trial.choice.method));
      CountStarts(reference.view.samples, run.value().start_face, &figures);
    }
    if (prepare.back() + trace.back() > kQuickMs) break;
  }
  figures.prepare_ms = Median(prepare);
  figures.trace_ms = Median(trace);
  return figures;
}

std::string MethodTrialName(const MethodTrial& trial) {
  const bool several = trial.choice.method->solver != nullptr && trial.choice.method->solver->takes_map;
  return trial.choice.Name() +
         (several && trial.starts
              ? std::string(", ") + kSolverStartsNames[static_cast<std::size_t>(*trial.starts)]
              : std::string());
}

std::string MethodTrialStem(const MethodTrial& trial) {
  std::string stem = MethodTrialName(trial);
  if (const std::size_t comma = stem.find(", "); comma != std::string::npos) stem.replace(comma, 2, "-");
  return stem;
}

Table MethodTable(const std::string& title, const std::vector<MethodFigures>& figures) {
  Table table;
  table.title = title;
  table.columns = {"method", "prepare",  "trace",     "solves/ray", "iterations/ray", "memory",
                   "lost",   "invented", "imprecise", "unresolved", "no start",       "wrong start"};
  std::uint64_t not_judged = 0;
  for (const MethodFigures& f : figures) {
    std::vector<std::string> row = {MethodTrialName(f.trial)};
    if (!f.missing.empty()) {
      row.resize(table.columns.size(), "-");
      table.notes.push_back(MethodTrialName(f.trial) + ": " + f.missing + ".");
    } else {
      const double rays = static_cast<double>(std::max<std::uint64_t>(f.rays, 1));
      row.insert(row.end(),
                 {MillisecondsText(f.prepare_ms), MillisecondsText(f.trace_ms),
                  ThreeDigits(static_cast<double>(f.solves) / rays),
                  ThreeDigits(static_cast<double>(f.iterations) / rays),
                  BytesText(static_cast<double>(f.bytes)), std::to_string(f.errors.count(HitError::kLost)),
                  std::to_string(f.errors.count(HitError::kInvented)),
                  std::to_string(f.errors.count(HitError::kImprecise)),
                  std::to_string(f.errors.count(HitError::kUnresolved)), CountOrDash(f.no_start),
                  CountOrDash(f.wrong_start)});
      not_judged = f.errors.count(HitError::kNotJudged);
    }
    table.rows.push_back(std::move(row));
  }
  table.notes.push_back(
      "One thread. Lost, invented, imprecise and unresolved count rays, judged by the certified image; " +
      std::to_string(not_judged) +
      " rays have no certificate and are not judged. No start and wrong start count the "
      "rays whose value in the map of preliminary values is missing or lies on another face.");
  return table;
}

Json MethodFiguresJson(const MethodFigures& f) {
  Json json = {{"method", f.trial.choice.Name()},
               {"starts", f.trial.starts ? Json(kSolverStartsNames[static_cast<std::size_t>(*f.trial.starts)])
                                         : Json(nullptr)},
               {"missing", f.missing.empty() ? Json(nullptr) : Json(f.missing)}};
  if (!f.missing.empty()) return json;
  Json errors = Json::object();
  for (std::size_t i = 1; i < kHitErrorNames.size(); ++i) errors[kHitErrorNames[i]] = f.errors.counts[i];
  json.update({{"timing_ms", {{"prepare", f.prepare_ms}, {"trace", f.trace_ms}}},
               {"repetitions", f.repetitions},
               {"rays", f.rays},
               {"hits", f.hits},
               {"solves", f.solves},
               {"iterations", f.iterations},
               {"bytes", f.bytes},
               {"errors", std::move(errors)},
               {"largest_px", f.errors.largest_px},
               {"no_start", f.no_start ? Json(*f.no_start) : Json(nullptr)},
               {"wrong_start", f.wrong_start ? Json(*f.wrong_start) : Json(nullptr)}});
  return json;
}

}  // namespace facetless
