#include "bench/sisojevs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "bench/method_bench.h"
#include "bench/statistics.h"
#include "bench/thesis_scenes.h"
#include "render/base/parallel.h"
#include "render/solve/solver.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// One method on one scene, run by run.
struct Trial {
  const SolverInfo* info = nullptr;
  SolverOptions options;
  std::vector<double> total_ms, trace_ms;
  SolverTrace last;
};

// A method whose first run takes more than this is not run again.
constexpr double kSlowMs = 10'000;

// The starts that the thesis describes for a method, the map as published, unless the table says others.
SolverOptions PublishedOptions(const ThesisMethod& method, const SolverInfo& info) {
  SolverOptions options;
  options.starts = method.starts;
  if (options.starts) return options;
  options.starts = info.starts == SolverStarts::kMap ? SolverStarts::kPublishedMap : info.starts;
  return options;
}

// Runs a method once, and remembers the times.
Result<void> Run(const Scene& scene, const Camera& camera, const Execution& one, Trial* trial) {
  Result<SolverTrace> traced = Error{};
  const double ms = MeasureMilliseconds(
      [&] { traced = TraceWithSolver(scene, camera, *trial->info, trial->options, {.execution = one}); });
  if (!traced.ok()) return traced.error();
  trial->last = std::move(traced).value();
  trial->total_ms.push_back(ms);
  trial->trace_ms.push_back(trial->last.stats.trace_ms);
  return {};
}

// Finds out whether a method takes the scene, and whether it has to be run again. Returns why it does not take it; empty:
// it does.
Result<std::string> FirstRun(const Scene& scene, const Camera& camera, const Execution& one, Trial* trial) {
  Result<void> run = Run(scene, camera, one, trial);
  if (!run.ok() && trial->options.starts == SolverStarts::kPublishedMap) {
    // The scene has more surfaces than 8 bits count.
    trial->options.starts = SolverStarts::kMap;
    run = Run(scene, camera, one, trial);
  }
  if (!run.ok() && run.error().code == ErrorCode::kCancelled) return run.error();
  if (!run.ok()) return run.error().message;
  return std::string();
}

// The published share of a method; nothing if the thesis does not have it.
std::optional<double> PublishedShare(const ThesisTable& table, std::size_t method, std::size_t scene) {
  if (table.methods[method].published.empty()) return std::nullopt;
  return table.methods[method].published[scene] / table.methods[table.base].published[scene];
}

double PerRay(const ThesisFigures& figures, std::uint64_t count) {
  return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(figures.stats.rays, 1));
}

double PerSolve(const ThesisFigures& figures) {
  const SolverCounters& counters = figures.stats.counters;
  return static_cast<double>(counters.iterations) /
         static_cast<double>(std::max<std::uint64_t>(counters.solves, 1));
}

double NanosecondsPerIteration(const ThesisFigures& figures) {
  return 1e6 * figures.trace_ms /
         static_cast<double>(std::max<std::uint64_t>(figures.stats.counters.iterations, 1));
}

std::string Percent(double share) {
  return ThreeDigits(100 * share) + " %";
}

std::string StartsName(const ThesisFigures& figures) {
  return kSolverStartsNames[static_cast<std::size_t>(figures.stats.starts)];
}

// "0.26 solves of 12.1 iterations of 105 ns"
std::string Work(const ThesisFigures& figures) {
  return ThreeDigits(PerRay(figures, figures.stats.counters.solves)) + " solves of " +
         ThreeDigits(PerSolve(figures)) + " iterations of " + ThreeDigits(NanosecondsPerIteration(figures)) +
         " ns";
}

// The sentence about the difference of a method from the published share.
std::string Difference(const ThesisTable& table, const ThesisScene& scene, std::size_t scene_index,
                       std::size_t method_index) {
  const ThesisFigures &figures = scene.methods[method_index], &base = scene.methods[table.base];
  const std::optional<double> published = PublishedShare(table, method_index, scene_index);
  const double preparing = 1 - figures.trace_ms / figures.total_ms;
  const std::uint64_t unresolved = figures.errors.count(HitError::kUnresolved);
  // Preparation is worth a word if it takes more than this.
  constexpr double kMuch = 0.2;
  std::string text = scene.name + ", " + figures.title + ": " + Percent(figures.total_ms / base.total_ms) +
                     (published ? " instead of the published " + Percent(*published) : std::string()) +
                     ", because a ray takes " + Work(figures) + ", and with " + base.title + " " + Work(base);
  if (unresolved > 0) text += "; " + std::to_string(unresolved) + " rays end at the limit of their work";
  if (preparing > kMuch) text += "; preparation is " + Percent(preparing) + " of the time";
  return text + ".";
}

Table TimeTable(const ThesisTable& table, const std::vector<ThesisScene>& scenes) {
  Table times;
  times.title = "Sisojevs, table " + std::to_string(table.number) + ": " + table.surfaces + ", " +
                std::to_string(table.width) + "×" + std::to_string(table.height) +
                ", time of a picture on one thread";
  times.columns = {"method"};
  for (const ThesisScene& scene : scenes)
    times.columns.insert(times.columns.end(), {scene.name, "share", "published share"});
  for (std::size_t m = 0; m < table.methods.size(); ++m) {
    std::vector<std::string> row;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const ThesisFigures &figures = scenes[s].methods[m], &base = scenes[s].methods[table.base];
      if (row.empty()) row.push_back(figures.title);
      const std::optional<double> published = PublishedShare(table, m, s);
      const bool exists = figures.missing.empty();
      row.insert(row.end(), {exists ? MillisecondsText(figures.total_ms) : "-",
                             exists && base.missing.empty() ? Percent(figures.total_ms / base.total_ms) : "-",
                             published ? Percent(*published) : "-"});
    }
    times.rows.push_back(std::move(row));
  }
  std::vector<std::string> direct = {"direct"};
  for (const ThesisScene& scene : scenes) {
    const ThesisFigures& base = scene.methods[table.base];
    direct.insert(direct.end(), {MillisecondsText(scene.direct_ms),
                                 base.missing.empty() ? Percent(scene.direct_ms / base.total_ms) : "-", "-"});
  }
  times.rows.push_back(std::move(direct));
  times.notes.push_back(
      "The scenes are our own, and resemble those of the thesis, whose models are not published. \"Direct\" "
      "is this "
      "program's renderer in standard precision: leaves with a proof, bitmaps, and eight rays at a time.");
  // The sentences are a list, in Markdown and in text.
  for (std::size_t s = 0; s < scenes.size(); ++s)
    for (std::size_t m = 0; m < table.methods.size(); ++m) {
      const ThesisFigures& figures = scenes[s].methods[m];
      if (!figures.missing.empty())
        times.notes.push_back("- " + scenes[s].name + ", " + figures.title + ": " + figures.missing + ".");
      else if (m != table.base && scenes[s].methods[table.base].missing.empty())
        times.notes.push_back("- " + Difference(table, scenes[s], s, m));
    }
  return times;
}

Table CountTable(const ThesisTable& table, const std::vector<ThesisScene>& scenes) {
  Table counts;
  counts.title = "Sisojevs, table " + std::to_string(table.number) + ": what the time was spent on";
  counts.columns = {"scene",         "method", "starts", "tracing",  "solves per ray", "iterations per solve",
                    "per iteration", "memory", "lost",   "invented", "imprecise",      "unresolved",
                    "no start"};
  for (const ThesisScene& scene : scenes) {
    for (const ThesisFigures& figures : scene.methods) {
      if (!figures.missing.empty()) continue;
      const SolverStats& stats = figures.stats;
      const auto errors = [&](HitError error) { return std::to_string(figures.errors.count(error)); };
      counts.rows.push_back(
          {scene.name, figures.title, StartsName(figures), MillisecondsText(figures.trace_ms),
           ThreeDigits(PerRay(figures, stats.counters.solves)), ThreeDigits(PerSolve(figures)),
           ThreeDigits(NanosecondsPerIteration(figures)) + " ns", BytesText(static_cast<double>(stats.bytes)),
           errors(HitError::kLost), errors(HitError::kInvented), errors(HitError::kImprecise),
           errors(HitError::kUnresolved),
           stats.starts == SolverStarts::kPieces ? "-" : std::to_string(stats.no_start)});
    }
    const double rays = static_cast<double>(std::max<std::uint64_t>(scene.direct.rays, 1)),
                 solves = static_cast<double>(std::max<std::uint64_t>(scene.direct.solves, 1)),
                 steps = static_cast<double>(std::max<std::uint64_t>(scene.direct.iterations, 1));
    counts.rows.push_back(
        {scene.name, "direct", "-", MillisecondsText(scene.direct_trace_ms), ThreeDigits(solves / rays),
         ThreeDigits(steps / solves), ThreeDigits(1e6 * scene.direct_trace_ms / steps) + " ns",
         BytesText(static_cast<double>(scene.direct.scene_bytes)), "-", "-", "-", "-", "-"});
  }
  counts.notes = {
      "The time of an iteration is that of tracing, divided by the number of iterations. It has its share of "
      "everything "
      "around them: subdivisions, boxes, trimming and normals. Lost, invented, imprecise and unresolved "
      "count rays, of " +
      std::to_string(scenes.empty() ? 0 : scenes[0].direct.rays) +
      ", judged by the certified image within the tolerance that the method states; \"no start\" counts the "
      "rays "
      "without a value in the map, those beside all surfaces included."};
  return counts;
}

}  // namespace

std::vector<ThesisTable> ThesisTables() {
  std::vector<ThesisTable> tables;
  // Minutes for the teapot, seconds for the duck.
  tables.push_back({2,
                    "Bézier surfaces",
                    640,
                    480,
                    0,
                    {{"gradient", {5.59, 20.39}},
                     {"bezier-clipping", {6.669, 169.154}},
                     {"robust-clipping", {6.681, 116.233}},
                     {"martin", {5.613, 20.922}},
                     {"coherent-newton", {5.63, 23.968}}},
                    {{"teapot", TeapotOnAPlane()}, {"bird", BezierBird()}}});
  // Seconds.
  tables.push_back({3,
                    "B-spline surfaces",
                    512,
                    512,
                    2,
                    {{"steepest-descent", {31.156, 98.313}},
                     {"gradient", {74.906, 180.234}},
                     {"martin", {60.750, 205.600}}},
                    {{"column", FlutedColumn()}, {"water lily", WaterLily()}}});
  // Minutes.
  tables.push_back({4,
                    "B-spline surfaces of a medical object",
                    512,
                    512,
                    2,
                    {{"steepest-descent", {17.683}}, {"gradient", {24.533}}, {"martin", {25.267}}},
                    {{"skull and pathology", SkullAndPathology()}}});
  // Seconds.
  tables.push_back({5,
                    "NURBS surfaces",
                    512,
                    512,
                    1,
                    {{"newton-cramer", {5.578, 9.000, 4.297, 1.890}},
                     {"martin", {6.437, 11.860, 5.422, 2.203}},
                     {"newton-cramer", {}, SolverStarts::kPieces}},
                    PatchScenes()});
  return tables;
}

Result<ThesisScene> MeasureThesisScene(const ThesisTable& table, const NamedScene& named,
                                       const ThesisOptions& options) {
  const Execution one{1, options.execution.cancel};
  const Scene scene(named.model);
  const Result<Camera> camera =
      NamedView("iso", named.model.bounds, Projection::kOrthographic,
                std::max(1, table.width / options.divisor), std::max(1, table.height / options.divisor));
  if (!camera.ok()) return camera.error();
  const Result<MethodReference> reference = MakeMethodReference(scene, camera.value(), one);
  if (!reference.ok()) return reference.error();

  ThesisScene measured;
  measured.name = named.name;
  measured.methods.resize(table.methods.size());
  std::vector<Trial> trials(table.methods.size());
  std::vector<std::function<void()>> runs;
  std::optional<Error> failed;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    ThesisFigures& figures = measured.methods[m];
    Trial& trial = trials[m];
    figures.name = figures.title = table.methods[m].name;
    trial.info = FindSolver(figures.name);
    if (trial.info == nullptr) {
      figures.missing = "there is no method of this name";
      continue;
    }
    figures.title = trial.info->title;
    trial.options = PublishedOptions(table.methods[m], *trial.info);
    if (table.methods[m].starts)
      figures.title +=
          std::string(", ") + kSolverStartsNames[static_cast<std::size_t>(*table.methods[m].starts)];
    Result<std::string> missing = FirstRun(scene, camera.value(), one, &trial);
    if (!missing.ok()) return missing.error();
    figures.missing = std::move(missing).value();
    if (!figures.missing.empty()) continue;
    if (trial.total_ms.front() > kSlowMs) continue;
    // The first run only warmed the caches.
    trial.total_ms.clear();
    trial.trace_ms.clear();
    runs.emplace_back([&, m] {
      if (const Result<void> run = Run(scene, camera.value(), one, &trials[m]); !run.ok())
        failed = run.error();
    });
  }
  DirectOptions direct_options;
  direct_options.execution = one;
  std::vector<double> direct_traces;
  runs.emplace_back([&] {
    Result<DirectResult> direct = TraceDirect(scene, camera.value(), direct_options);
    if (!direct.ok()) {
      failed = direct.error();
      return;
    }
    measured.direct = direct.value().stats;
    direct_traces.push_back(measured.direct.trace_ms);
  });
  std::vector<std::vector<double>> ms;
  RunWithThreads(1, [&] { ms = TakeTurns(options.repeats, runs); });
  if (failed) return *failed;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    ThesisFigures& figures = measured.methods[m];
    const Trial& trial = trials[m];
    if (!figures.missing.empty()) continue;
    figures.total_ms = Median(trial.total_ms);
    figures.trace_ms = Median(trial.trace_ms);
    figures.stats = trial.last.stats;
    figures.errors = JudgeHits({reference.value().view.samples, reference.value().view.frame},
                               trial.last.samples, trial.info->tolerance_px);
    figures.errors.of.clear();
  }
  measured.direct_ms = Median(ms.back());
  measured.direct_trace_ms = Median(direct_traces);
  return measured;
}

std::vector<Table> ThesisTexts(const ThesisTable& table, const std::vector<ThesisScene>& scenes) {
  return {TimeTable(table, scenes), CountTable(table, scenes)};
}

Json ThesisJson(const ThesisTable& table, const std::vector<ThesisScene>& scenes) {
  Json json = {
      {"table", table.number}, {"width", table.width}, {"height", table.height}, {"scenes", Json::array()}};
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const ThesisScene& scene = scenes[s];
    Json methods = Json::array();
    for (std::size_t m = 0; m < scene.methods.size(); ++m) {
      const ThesisFigures& figures = scene.methods[m];
      const std::optional<double> published = PublishedShare(table, m, s);
      Json row = {{"method", figures.name},
                  {"published_share", published ? Json(*published) : Json(nullptr)}};
      if (!figures.missing.empty()) {
        row["missing"] = figures.missing;
        methods.push_back(std::move(row));
        continue;
      }
      Json errors = Json::object(), stops = Json::object();
      for (std::size_t i = 1; i < kHitErrorNames.size(); ++i)
        errors[kHitErrorNames[i]] = figures.errors.counts[i];
      for (std::size_t i = 0; i < kSolverStopNames.size(); ++i)
        stops[kSolverStopNames[i]] = figures.stats.counters.stops[i];
      row.update({{"starts", StartsName(figures)},
                  {"total_ms", figures.total_ms},
                  {"trace_ms", figures.trace_ms},
                  {"bytes", figures.stats.bytes},
                  {"pieces", figures.stats.pieces},
                  {"solves", figures.stats.counters.solves},
                  {"iterations", figures.stats.counters.iterations},
                  {"roots", figures.stats.counters.roots},
                  {"hits", figures.stats.hits},
                  {"no_start", figures.stats.no_start},
                  {"stops", std::move(stops)},
                  {"errors", std::move(errors)},
                  {"largest_px", figures.errors.largest_px}});
      methods.push_back(std::move(row));
    }
    json["scenes"].push_back({{"scene", scene.name},
                              {"rays", scene.direct.rays},
                              {"methods", std::move(methods)},
                              {"direct",
                               {{"total_ms", scene.direct_ms},
                                {"trace_ms", scene.direct_trace_ms},
                                {"bytes", scene.direct.scene_bytes},
                                {"leaves", scene.direct.leaves},
                                {"solves", scene.direct.solves},
                                {"iterations", scene.direct.iterations},
                                {"hits", scene.direct.hits},
                                {"certified", scene.direct.certified}}}});
  }
  return json;
}

}  // namespace facetless
