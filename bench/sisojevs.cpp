#include "bench/sisojevs.h"

#include <optional>
#include <span>

#include "bench/statistics.h"
#include "render/base/parallel.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The published shares: the thesis's time divided by the time of Martin's method, for its scenes "Duck", "27
// ducks", "Mobile phone" and "Machine element".
constexpr double kPublishedShare[] = {0.8666, 0.7589, 0.7925, 0.8579};

// Depths that differ by more than this belong to different roots. It is the tolerance of a pixel's residual,
// magnified by grazing incidence.
double DepthTolerance(const CameraFrame& frame) {
  constexpr double kGrazing = 1e3;
  return kGrazing * kSceneTolerancePx * std::max(frame.pixel_x, frame.pixel_y);
}

std::string Percent(double share) {
  return ThreeDigits(100 * share) + " %";
}

double Share(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

Json ImageJson(const PatchImage& image, double total_ms, double trace_ms,
               const DepthDifferences& differences) {
  return {{"total_ms", total_ms},
          {"trace_ms", trace_ms},
          {"bytes", image.bytes},
          {"box_tests", image.box_tests},
          {"solves", image.solves},
          {"iterations", image.iterations},
          {"roots", image.roots},
          {"hits", image.hits},
          {"against_direct",
           {{"both_hit", differences.both_hit},
            {"only_here", differences.only_first},
            {"only_direct", differences.only_second},
            {"apart", differences.apart},
            {"largest_mm", differences.largest_mm}}}};
}

std::uint64_t Count(const DepthDifferences& differences) {
  return differences.only_first + differences.only_second + differences.apart;
}

}  // namespace

Result<ThesisScene> MeasureThesisScene(const NamedScene& scene, int size, int repeats) {
  const std::vector<ScenePatch> patches = PatchesOf(scene.model);
  const Result<Camera> camera = NamedView("iso", scene.model.bounds, Projection::kOrthographic, size, size);
  if (!camera) return camera.error();
  const Result<CameraFrame> frame = MakeFrame(camera.value(), scene.model.Diagonal());
  if (!frame) return frame.error();

  ThesisScene measured;
  measured.name = scene.name;
  measured.patches = patches.size();
  measured.pieces = BuildPatchTree(patches, kFlattening).pieces.size();
  std::optional<Result<DirectResult>> direct;
  std::vector<double> traces[3];
  DirectOptions options;
  options.execution.threads = 1;
  const std::vector<std::vector<double>> ms = TakeTurns(
      repeats, {[&] {
                  measured.martin = TraceMartin(patches, frame.value(), size, size);
                  traces[0].push_back(measured.martin.trace_ms);
                },
                [&] {
                  measured.newton_cramer = TraceNewtonCramer(patches, frame.value(), size, size);
                  traces[1].push_back(measured.newton_cramer.trace_ms);
                },
                [&] {
                  RunWithThreads(1,
                                 [&] { direct = TraceDirect(Scene(scene.model), camera.value(), options); });
                  if (direct->ok()) traces[2].push_back(direct->value().stats.trace_ms);
                }});
  if (!direct->ok()) return direct->error();
  measured.martin_ms = Median(ms[0]);
  measured.newton_cramer_ms = Median(ms[1]);
  measured.direct_ms = Median(ms[2]);
  measured.martin_trace_ms = Median(traces[0]);
  measured.newton_cramer_trace_ms = Median(traces[1]);
  measured.direct_trace_ms = Median(traces[2]);
  measured.direct = direct->value().stats;
  measured.direct_bytes = measured.direct.scene_bytes;
  const std::span<const double> exact = direct->value().samples.depth;
  measured.martin_differences = CompareDepths(measured.martin.depth, exact, DepthTolerance(frame.value()));
  measured.newton_cramer_differences =
      CompareDepths(measured.newton_cramer.depth, exact, DepthTolerance(frame.value()));
  return measured;
}

std::vector<Table> ThesisTables(const std::vector<ThesisScene>& scenes) {
  Table times;
  times.title = "Newton–Cramer (Sisojevs, table 5): time of a picture, one thread";
  times.columns = {"scene", "patches",         "Martin et al.", "Newton–Cramer",
                   "share", "published share", "direct",        "share"};
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const ThesisScene& scene = scenes[i];
    times.rows.push_back({scene.name, std::to_string(scene.patches), MillisecondsText(scene.martin_ms),
                          MillisecondsText(scene.newton_cramer_ms),
                          Percent(scene.newton_cramer_ms / scene.martin_ms),
                          i < std::size(kPublishedShare) ? Percent(kPublishedShare[i]) : "-",
                          MillisecondsText(scene.direct_ms), Percent(scene.direct_ms / scene.martin_ms)});
  }
  times.notes = {
      "Both methods share pieces, tree, evaluation, tolerance and rules for stopping. So the share shows "
      "what "
      "projecting first saves: a component and the quotient rule in each step, and box tests with four "
      "comparisons. In the thesis the starts came from a rasterised map of parameters instead of a tree, on "
      "other scenes and another machine.",
      "The column \"direct\" is this program's renderer in standard precision: leaves with a proof, bitmaps, "
      "and eight rays at a time."};
  Table counts;
  counts.title = "Newton–Cramer: what the time was spent on";
  counts.columns = {"scene",           "method",
                    "tracing",         "solves per ray",
                    "steps per solve", "solves that a pixel shows",
                    "memory",          "rays unlike direct"};
  for (const ThesisScene& scene : scenes) {
    const double rays = static_cast<double>(scene.direct.rays);
    const auto line = [&](const char* method, double ms, std::uint64_t solves, std::uint64_t iterations,
                          std::uint64_t hits, std::size_t bytes, const std::string& unlike) {
      counts.rows.push_back({scene.name, method, MillisecondsText(ms),
                             ThreeDigits(static_cast<double>(solves) / rays),
                             ThreeDigits(Share(iterations, solves)), Percent(Share(hits, solves)),
                             BytesText(static_cast<double>(bytes)), unlike});
    };
    line("Martin et al.", scene.martin_trace_ms, scene.martin.solves, scene.martin.iterations,
         scene.martin.hits, scene.martin.bytes, std::to_string(Count(scene.martin_differences)));
    line("Newton–Cramer", scene.newton_cramer_trace_ms, scene.newton_cramer.solves,
         scene.newton_cramer.iterations, scene.newton_cramer.hits, scene.newton_cramer.bytes,
         std::to_string(Count(scene.newton_cramer_differences)));
    line("direct", scene.direct_trace_ms, scene.direct.solves, scene.direct.iterations, scene.direct.hits,
         scene.direct_bytes, "");
  }
  counts.notes = {
      "Martin et al. report that 8 to 31 % of the solves become hits, and 2 to 3 steps per solve.",
      "The last column counts the rays, of " + std::to_string(scenes.empty() ? 0 : scenes[0].direct.rays) +
          ", whose answer differs from the direct image. The stopping rules of both methods give up some "
          "roots "
          "near silhouettes and borders of patches, by design."};
  return {times, counts};
}

Json ThesisJson(const std::vector<ThesisScene>& scenes) {
  Json json = Json::array();
  for (const ThesisScene& scene : scenes)
    json.push_back(
        {{"scene", scene.name},
         {"patches", scene.patches},
         {"pieces", scene.pieces},
         {"rays", scene.direct.rays},
         {"martin",
          ImageJson(scene.martin, scene.martin_ms, scene.martin_trace_ms, scene.martin_differences)},
         {"newton_cramer", ImageJson(scene.newton_cramer, scene.newton_cramer_ms,
                                     scene.newton_cramer_trace_ms, scene.newton_cramer_differences)},
         {"direct",
          {{"total_ms", scene.direct_ms},
           {"trace_ms", scene.direct_trace_ms},
           {"bytes", scene.direct_bytes},
           {"leaves", scene.direct.leaves},
           {"solves", scene.direct.solves},
           {"iterations", scene.direct.iterations},
           {"hits", scene.direct.hits},
           {"certified", scene.direct.certified}}}});
  return json;
}

}  // namespace facetless
