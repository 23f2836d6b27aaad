#include "render/trade/trade_report.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include "render/trade/quantity_text.h"

namespace facetless {
namespace {

using nlohmann::json;

json Finite(double value) {
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json SpreadJson(const Spread& spread) {
  return {{"mean", spread.mean}, {"mean_abs", spread.mean_abs}, {"p50", spread.p50},     {"p95", spread.p95},
          {"p99", spread.p99},   {"max", spread.max},           {"pixels", spread.count}};
}

json SettingJson(const TradeSetting& setting) {
  json out = {{"tracer", TracerName(setting)}, {"name", SettingName(setting)}};
  if (const auto* mesh = std::get_if<MeshSetting>(&setting)) {
    out["deflection"] = mesh->deflection;
    out["angular_deg"] = mesh->angular_deg;
  } else if (const auto* direct = std::get_if<DirectSetting>(&setting)) {
    constexpr const char* kNames[] = {"fast", "standard", "certified"};
    out["precision"] = kNames[static_cast<int>(direct->precision)];
    out["newton_tolerance"] = direct->newton_tolerance > 0 ? json(direct->newton_tolerance) : json(nullptr);
  } else if (const auto& choice = std::get<MethodChoice>(setting); !choice.method->setting.empty()) {
    out["setting"] = choice.setting;
  }
  return out;
}

json NameOrNull(const std::optional<std::size_t>& index, const TradeView& view) {
  return index ? json(SettingName(view.points[*index].setting)) : json(nullptr);
}

template <typename T>
json OrNull(const std::optional<T>& value) {
  return value ? json(*value) : json(nullptr);
}

// Pads a UTF-8 text on the right to `width` columns, counted in characters.
std::string Padded(const std::string& text, std::size_t width, bool right = false) {
  std::size_t columns = 0;
  for (const char c : text) columns += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  const std::string space(columns < width ? width - columns : 0, ' ');
  return right ? space + text : text + space;
}

}  // namespace

const char* MeasureName(ErrorMeasure measure) {
  constexpr const char* kNames[] = {"mean", "p95", "p99", "max"};
  return kNames[static_cast<int>(measure)];
}

void AnswerQuestions(TradeView& view, const TradeLimits& limits) {
  MarkFronts(view.points, view.context.measure, view.context.floor_mm);
  view.limits.clear();
  view.crossovers.clear();
  if (limits.error_mm) view.limits.push_back(AnswerLimit(view.points, false, *limits.error_mm, view.context));
  if (limits.error_px) view.limits.push_back(AnswerLimit(view.points, true, *limits.error_px, view.context));
  for (const TradeCost cost : {TradeCost::kTime, TradeCost::kMemory})
    view.crossovers.push_back(AnswerCrossover(view.points, cost, view.context));
  view.methods = MethodSentences(view.points, view.context);
  view.next_view = NextViewSentence(view.points, view.limits);
}

std::vector<std::string> Sentences(const TradeView& view) {
  std::vector<std::string> sentences;
  for (const LimitAnswer& answer : view.limits) sentences.push_back(answer.sentence);
  for (const CrossoverAnswer& answer : view.crossovers) sentences.push_back(answer.sentence);
  sentences.insert(sentences.end(), view.methods.begin(), view.methods.end());
  if (!view.next_view.empty()) sentences.push_back(view.next_view);
  return sentences;
}

json TradePointJson(const TradePoint& point, const std::string& view) {
  json out = SettingJson(point.setting);
  out["view"] = view;
  out["measured"] = point.measured();
  if (!point.measured()) {
    out["skipped"] = point.skipped;
    return out;
  }
  const bool mesh = IsMesh(point.setting);
  out["repetitions"] = point.repetitions;
  out["timing_ms"] = {{"prepare", point.prepare_ms}, {"trace", point.trace_ms},
                      {"shade", point.shade_ms},     {"total", point.total_ms},
                      {"model", point.model_ms},     {"next_view", point.total_ms - point.model_ms},
                      {"picture", point.picture_ms}};
  out["timing_ms"]["fastest_view"] = point.fastest_ms;
  out["timing_ms"]["slowest_view"] = point.slowest_ms;
  if (mesh) {
    out["mesh_repetitions"] = point.mesh_repetitions;
    out["timing_ms"]["mesh"] = point.mesh_ms;
    out["timing_ms"]["build"] = point.build_ms;
    out["triangles"] = point.triangles;
    out["deflection_mm"] = point.deflection_mm;
    out["mesher_peak_bytes"] = point.mesher_peak_bytes > 0 ? json(point.mesher_peak_bytes) : json(nullptr);
  } else {
    out["timing_ms"]["convert"] = point.convert_ms;
    out["timing_ms"]["scene"] = point.scene_ms;
    out["timing_ms"]["leaves"] = point.leaves_ms;
    out["leaves"] = point.leaves;
    if (!IsDirect(point.setting)) out["timing_ms"]["make"] = point.make_ms;
  }
  out["tracer_peak_bytes"] = point.tracer_peak_bytes;
  out["peak_bytes"] = point.peak_bytes;
  out["depth_mm"] = SpreadJson(point.depth_mm);
  out["deviation_mm"] = SpreadJson(point.deviation_mm);
  out["silhouette"] = {{"pixels", point.silhouette.pixels},
                       {"max_distance_px", Finite(point.silhouette.max_distance_px)},
                       {"offset_px", point.silhouette_offset_px}};
  out["flip"] = {{"mean", point.flip_mean}, {"p95", point.flip_p95}};
  out["pareto"] = {{"time", point.on_time_front}, {"memory", point.on_memory_front}};
  return out;
}

json LimitAnswerJson(const LimitAnswer& answer, const TradeView& view) {
  return {{"question", answer.pixels ? "max_error_px" : "max_error_mm"},
          {"view", view.context.view},
          {"limit", answer.limit},
          {"mesh", NameOrNull(answer.mesh, view)},
          {"direct", NameOrNull(answer.direct, view)},
          {"deflection_interpolated", OrNull(answer.deflection)},
          {"sentence", answer.sentence}};
}

json CrossoverAnswerJson(const CrossoverAnswer& answer, const TradeView& view) {
  constexpr const char* kKinds[] = {"unknown", "direct", "mesh", "at"};
  return {{"question", answer.cost == TradeCost::kTime ? "direct_cheaper_time" : "direct_cheaper_memory"},
          {"view", view.context.view},
          {"cheaper", kKinds[static_cast<int>(answer.kind)]},
          {"error_mm", OrNull(answer.error_mm)},
          {"finest_mesh_mm", OrNull(answer.finest_mm)},
          {"between", json::array({NameOrNull(answer.coarser, view), NameOrNull(answer.finer, view)})},
          {"sentence", answer.sentence}};
}

std::string TradeTable(const TradeView& view) {
  constexpr std::size_t kName = 26, kCell = 10;
  std::string table = Padded("view " + view.context.view, kName);
  for (const char* head :
       {"prepare", "trace", "shade", "total", "memory", "p99 mm", "max mm", "outline px", "FLIP"})
    table += Padded(head, kCell + 1, true);
  table += "\n";
  for (const TradePoint& point : view.points) {
    table += Padded(SettingName(point.setting), kName);
    if (!point.measured()) {
      table += "  not measured: " + point.skipped + "\n";
      continue;
    }
    for (const std::string& cell :
         {TimeText(point.prepare_ms), TimeText(point.trace_ms), TimeText(point.shade_ms),
          TimeText(point.total_ms), MemoryText(static_cast<double>(point.peak_bytes)),
          NumberText(point.deviation_mm.p99), NumberText(point.deviation_mm.max),
          NumberText(point.silhouette_offset_px), NumberText(point.flip_mean)})
      table += Padded(cell, kCell + 1, true);
    if (point.on_time_front) table += " *";
    table += "\n";
  }
  return table + "* nothing measured is both faster and more accurate\n";
}

LogPlot TradePlot(const TradeView& view, TradeCost cost, const std::string& model_name) {
  const bool time = cost == TradeCost::kTime;
  LogPlot plot;
  plot.title = model_name + ": " + (time ? "time" : "memory") + " against error";
  const Camera& camera = view.reference.camera;
  plot.subtitle = "View " + view.context.view + ", " + std::to_string(camera.width_px) + " × " +
                  std::to_string(camera.height_px) + " pixels of " +
                  MillimetresText(view.context.mm_per_pixel) +
                  ". Further left is more accurate, further down is cheaper.";
  plot.x_title =
      std::string("error: distance to the exact surface, mm (") + MeasureText(view.context.measure) + ")";
  plot.y_title = time ? "total time for the view" : "peak memory";
  plot.front_title = time ? "nothing measured is both faster and more accurate"
                          : "nothing measured is both smaller and more accurate";
  plot.y_unit = time ? PlotUnit::kMilliseconds : PlotUnit::kBytes;
  plot.x_floor = view.context.floor_mm;
  plot.pixels_per_mm = 1 / view.context.mm_per_pixel;
  plot.series = {{"direct"}, {"mesh: deflection, angle"}};
  // Add one series for each method.
  std::map<std::string, std::size_t> series_of = {{"direct", 0}, {"mesh", 1}};
  for (const TradePoint& point : view.points)
    if (const auto* choice = std::get_if<MethodChoice>(&point.setting);
        choice != nullptr && series_of.try_emplace(choice->method->name, plot.series.size()).second)
      plot.series.push_back({choice->method->setting.empty()
                                 ? choice->method->title
                                 : choice->method->title + ": " + choice->method->setting});
  if (!view.limits.empty()) {
    const LimitAnswer& limit = view.limits.front();
    plot.x_limit = limit.pixels ? limit.limit * view.context.mm_per_pixel : limit.limit;
    plot.x_limit_label =
        "limit " + (limit.pixels ? NumberText(limit.limit) + " px" : MillimetresText(limit.limit));
  }

  // Add the points; chains of the meshes of one angle and of the settings of one method; and notes of what
  // was not measured.
  std::map<std::pair<std::size_t, double>, std::vector<std::size_t>> chains;
  std::vector<std::size_t> plotted(view.points.size());
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const TradePoint& point = view.points[i];
    if (!point.measured()) {
      plot.notes.push_back("Not measured: " + SettingName(point.setting) + ": " + point.skipped + ".");
      continue;
    }
    const std::size_t series = series_of.at(TracerName(point.setting));
    plotted[i] = plot.points.size();
    const auto* mesh = std::get_if<MeshSetting>(&point.setting);
    if (!IsDirect(point.setting))
      chains[{series, mesh != nullptr ? mesh->angular_deg : 0}].push_back(plot.points.size());
    plot.points.push_back({point.ErrorMm(view.context.measure), TradePointCost(point, cost), series,
                           ShortSettingName(point.setting),
                           time ? point.on_time_front : point.on_memory_front});
  }
  for (auto& [ladder, chain] : chains) plot.chains.push_back(std::move(chain));
  for (const std::size_t i : ParetoFront(view.points, cost, view.context.measure, view.context.floor_mm))
    plot.front.push_back(plotted[i]);
  return plot;
}

}  // namespace facetless
