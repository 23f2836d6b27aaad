#include "render/trade/trade_answers.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "render/trade/quantity_text.h"

namespace facetless {
namespace {

double ErrorOf(const TradePoint& point, bool pixels, ErrorMeasure measure) {
  return pixels ? point.ErrorPx(measure) : point.ErrorMm(measure);
}

// Returns the measured point with the smallest time among those within the limit for which `belongs` is true.
std::optional<std::size_t> CheapestWithin(const std::vector<TradePoint>& points,
                                          bool (*belongs)(const TradeSetting& setting), bool pixels,
                                          double limit, ErrorMeasure measure) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TradePoint& point = points[i];
    if (!point.measured() || !belongs(point.setting)) continue;
    // Written this way, a NaN exceeds every limit.
    if (!(ErrorOf(point, pixels, measure) <= limit)) continue;
    if (!best || point.total_ms < points[*best].total_ms) best = i;
  }
  return best;
}

// Returns, for each method, the measured point with the smallest time among those within the limit.
std::vector<std::size_t> CheapestMethodsWithin(const std::vector<TradePoint>& points, bool pixels,
                                               double limit, ErrorMeasure measure) {
  std::map<std::string, std::size_t> cheapest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TradePoint& point = points[i];
    if (!point.measured() || IsMesh(point.setting) || IsDirect(point.setting)) continue;
    if (!(ErrorOf(point, pixels, measure) <= limit)) continue;
    const auto [best, first] = cheapest.try_emplace(TracerName(point.setting), i);
    if (!first && point.total_ms < points[best->second].total_ms) best->second = i;
  }
  std::vector<std::size_t> found;
  for (const auto& [name, i] : cheapest) found.push_back(i);
  return found;
}

// Returns y at x on the line through two points in log–log scale. Requires positive numbers, and x between x0
// and x1.
double LogInterpolate(double x, double x0, double y0, double x1, double y1) {
  if (x0 == x1) return y1;
  const double t = (std::log(x) - std::log(x0)) / (std::log(x1) - std::log(x0));
  return std::exp(std::log(y0) + t * (std::log(y1) - std::log(y0)));
}

const MeshSetting& MeshOf(const TradePoint& point) {
  return std::get<MeshSetting>(point.setting);
}

// Returns the measured meshes of one angle, the coarsest first.
std::vector<std::size_t> Ladder(const std::vector<TradePoint>& points, double angular_deg) {
  std::vector<std::size_t> ladder;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].measured() && IsMesh(points[i].setting) && MeshOf(points[i]).angular_deg == angular_deg)
      ladder.push_back(i);
  std::stable_sort(ladder.begin(), ladder.end(), [&](std::size_t a, std::size_t b) {
    return MeshOf(points[a]).deflection > MeshOf(points[b]).deflection;
  });
  return ladder;
}

// Returns the deflection at which the meshes of `angular_deg` cross the limit, if two measured neighbours
// enclose it.
std::optional<double> CrossingDeflection(const std::vector<TradePoint>& points, double angular_deg,
                                         bool pixels, double limit, ErrorMeasure measure) {
  const std::vector<std::size_t> ladder = Ladder(points, angular_deg);
  for (std::size_t k = 1; k < ladder.size(); ++k) {
    const TradePoint &coarse = points[ladder[k - 1]], &fine = points[ladder[k]];
    const double above = ErrorOf(coarse, pixels, measure), below = ErrorOf(fine, pixels, measure);
    if (!(above > limit && below <= limit) || !(below > 0)) continue;
    return LogInterpolate(limit, above, MeshOf(coarse).deflection, below, MeshOf(fine).deflection);
  }
  return std::nullopt;
}

// Returns "; mesh 1e-5, 30° was not measured: …" for the coarsest skipped mesh.
std::string SkippedText(const std::vector<TradePoint>& points) {
  for (const TradePoint& point : points)
    if (IsMesh(point.setting) && !point.measured())
      return "; " + SettingName(point.setting) + " was not measured: " + point.skipped;
  return "";
}

// Returns the measured mesh with the smallest error.
std::optional<std::size_t> FinestMesh(const std::vector<TradePoint>& points, bool pixels,
                                      ErrorMeasure measure) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].measured() && IsMesh(points[i].setting) &&
        (!best || ErrorOf(points[i], pixels, measure) < ErrorOf(points[*best], pixels, measure)))
      best = i;
  return best;
}

std::string CostText(const TradePoint& point) {
  return TimeText(point.total_ms) + " and " + MemoryText(static_cast<double>(point.peak_bytes));
}

std::string ErrorText(double error, bool pixels) {
  return pixels ? NumberText(error) + " px" : MillimetresText(error);
}

std::string LimitSentence(const std::vector<TradePoint>& points, const LimitAnswer& answer,
                          const TradeQuestionContext& context) {
  const auto error_of = [&](std::size_t i) { return ErrorOf(points[i], answer.pixels, context.measure); };
  const std::string limit = ErrorText(answer.limit, answer.pixels);
  const bool other_unit = context.mm_per_pixel > 0;
  std::string sentence = "View " + context.view + ", error up to " + limit;
  if (other_unit)
    sentence +=
        " (" +
        ErrorText(answer.pixels ? answer.limit * context.mm_per_pixel : answer.limit / context.mm_per_pixel,
                  !answer.pixels) +
        ")";
  sentence += ": ";
  if (answer.mesh) {
    const TradePoint& mesh = points[*answer.mesh];
    sentence += SettingName(mesh.setting) + " keeps it for " + CostText(mesh) + " (" +
                ErrorText(error_of(*answer.mesh), answer.pixels) + " in " + MeasureText(context.measure) +
                ", " + MillimetresText(mesh.deviation_mm.max) + " at most)";
    if (answer.deflection)
      sentence += "; by interpolation a deflection of about " + NumberText(*answer.deflection) + " would do";
  } else if (const auto finest = FinestMesh(points, answer.pixels, context.measure)) {
    sentence += "no mesh that was measured keeps it; " + SettingName(points[*finest].setting) + " comes to " +
                ErrorText(error_of(*finest), answer.pixels) + SkippedText(points);
  } else {
    sentence += "no mesh was measured" + SkippedText(points);
  }
  sentence += ". ";
  if (answer.direct) {
    const TradePoint& direct = points[*answer.direct];
    sentence += "Direct, " + SettingName(direct.setting) + ", keeps it for " + CostText(direct) + ".";
  } else {
    sentence += "No direct setting that was measured keeps it.";
  }
  for (const std::size_t i : answer.methods)
    sentence += " " + SettingName(points[i].setting) + " keeps it for " + CostText(points[i]) + ".";
  return sentence;
}

// Returns the smallest cost of direct rendering with an error of at most `error_mm`; infinite if no setting
// has so small an error.
double DirectCost(const std::vector<TradePoint>& points, TradeCost cost, double error_mm,
                  const TradeQuestionContext& context) {
  double least = INFINITY;
  for (const TradePoint& point : points)
    if (point.measured() && IsDirect(point.setting) &&
        std::fmax(point.ErrorMm(context.measure), context.floor_mm) <= error_mm)
      least = std::fmin(least, TradePointCost(point, cost));
  return least;
}

std::string CrossoverSentence(const std::vector<TradePoint>& points, const CrossoverAnswer& answer,
                              const TradeQuestionContext& context, const std::vector<std::size_t>& front) {
  const std::string what = answer.cost == TradeCost::kTime ? "Time" : "Memory";
  const std::string start = what + ", view " + context.view + ": ";
  const auto text_of = [&](std::size_t i) {
    const double cost = TradePointCost(points[i], answer.cost);
    return SettingName(points[i].setting) + ", " +
           (answer.cost == TradeCost::kTime ? TimeText(cost) : MemoryText(cost));
  };
  const std::string adjective = answer.cost == TradeCost::kTime ? "cheaper" : "smaller";
  switch (answer.kind) {
    case Crossover::kUnknown:
      return start + "nothing can be said, since one of the tracers was not measured" + SkippedText(points) +
             ".";
    case Crossover::kAlwaysDirect:
      return start + "direct is " + adjective + " than every mesh that was measured, from " +
             MillimetresText(points[front.front()].ErrorMm(context.measure)) + " (" + text_of(front.front()) +
             ") on; coarser meshes were not measured.";
    case Crossover::kAlwaysMesh:
      if (*answer.finest_mm <= context.floor_mm)
        return start + "the mesh is " + adjective + " (" + text_of(front.back()) +
               "), and exact: what is seen here is flat.";
      return start + "the mesh is " + adjective + " at every accuracy that was measured, down to " +
             MillimetresText(*answer.finest_mm) + " (" + text_of(front.back()) + ")" + SkippedText(points) +
             ".";
    case Crossover::kAt:
      break;
  }
  return start + "direct is " + adjective + " from an accuracy of about " +
         MillimetresText(*answer.error_mm) + " on (" +
         NumberText(*answer.error_mm / std::fmax(context.mm_per_pixel, 1e-300)) +
         " px), interpolated between " + text_of(*answer.coarser) + ", and " + text_of(*answer.finer) + ".";
}

}  // namespace

const char* MeasureText(ErrorMeasure measure) {
  constexpr const char* kTexts[] = {"the mean", "95 % of the pixels", "99 % of the pixels", "all pixels"};
  return kTexts[static_cast<int>(measure)];
}

LimitAnswer AnswerLimit(const std::vector<TradePoint>& points, bool pixels, double limit,
                        const TradeQuestionContext& context) {
  LimitAnswer answer;
  answer.pixels = pixels;
  answer.limit = limit;
  answer.mesh = CheapestWithin(points, IsMesh, pixels, limit, context.measure);
  answer.direct = CheapestWithin(points, IsDirect, pixels, limit, context.measure);
  if (answer.mesh) {
    answer.angular_deg = MeshOf(points[*answer.mesh]).angular_deg;
    answer.deflection = CrossingDeflection(points, answer.angular_deg, pixels, limit, context.measure);
  }
  answer.methods = CheapestMethodsWithin(points, pixels, limit, context.measure);
  answer.sentence = LimitSentence(points, answer, context);
  return answer;
}

CrossoverAnswer AnswerCrossover(const std::vector<TradePoint>& points, TradeCost cost,
                                const TradeQuestionContext& context) {
  CrossoverAnswer answer;
  answer.cost = cost;
  // Find the meshes that no other mesh beats, the coarsest first, and whether any direct setting was
  // measured.
  std::vector<TradePoint> meshes = points;
  bool any_direct = false;
  for (TradePoint& point : meshes) {
    any_direct = any_direct || (point.measured() && IsDirect(point.setting));
    if (!IsMesh(point.setting)) point.skipped = "another representation";
  }
  const std::vector<std::size_t> front = ParetoFront(meshes, cost, context.measure, context.floor_mm);
  const auto error_of = [&](std::size_t i) {
    return std::fmax(points[i].ErrorMm(context.measure), context.floor_mm);
  };
  if (front.empty() || !any_direct) {
    answer.sentence = CrossoverSentence(points, answer, context, front);
    return answer;
  }
  answer.finest_mm = error_of(front.back());

  // Between breakpoints the cost of direct is constant, and that of the mesh falls as errors grow. So direct
  // is cheaper on the whole interval below a breakpoint if it is cheaper at the breakpoint, with the settings
  // that are accurate enough below it.
  std::vector<double> breakpoints;
  for (const std::size_t i : front) breakpoints.push_back(error_of(i));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].measured() && error_of(i) > *answer.finest_mm && error_of(i) < error_of(front.front()))
      breakpoints.push_back(error_of(i));
  std::sort(breakpoints.begin(), breakpoints.end());
  const auto mesh_cost = [&](double error) {
    std::size_t k = 1;
    while (k + 1 < front.size() && error_of(front[k]) > error) ++k;
    return LogInterpolate(error, error_of(front[k - 1]), TradePointCost(points[front[k - 1]], cost),
                          error_of(front[k]), TradePointCost(points[front[k]], cost));
  };
  if (!(DirectCost(points, cost, *answer.finest_mm, context) < TradePointCost(points[front.back()], cost))) {
    answer.kind = Crossover::kAlwaysMesh;
    answer.sentence = CrossoverSentence(points, answer, context, front);
    return answer;
  }
  answer.kind = Crossover::kAlwaysDirect;
  for (std::size_t k = 0; k + 1 < breakpoints.size() && answer.kind == Crossover::kAlwaysDirect; ++k) {
    const double direct_cost = DirectCost(points, cost, breakpoints[k], context);
    if (breakpoints[k] == breakpoints[k + 1] || direct_cost < mesh_cost(breakpoints[k + 1])) continue;
    // Bisect the interval of log(error) until the costs are equal. A double cannot be halved more often.
    answer.kind = Crossover::kAt;
    double low = std::log(breakpoints[k]), high = std::log(breakpoints[k + 1]);
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (direct_cost < mesh_cost(std::exp(middle)) ? low : high) = middle;
    }
    answer.error_mm = std::exp(low);
    std::size_t finer = 1;
    while (finer + 1 < front.size() && error_of(front[finer]) > *answer.error_mm) ++finer;
    answer.coarser = front[finer - 1];
    answer.finer = front[finer];
  }
  answer.sentence = CrossoverSentence(points, answer, context, front);
  return answer;
}

std::vector<std::string> MethodSentences(const std::vector<TradePoint>& points,
                                         const TradeQuestionContext& context) {
  // The measured points of each method.
  std::map<std::string, std::vector<const TradePoint*>> methods;
  for (const TradePoint& point : points)
    if (point.measured() && !IsMesh(point.setting) && !IsDirect(point.setting))
      methods[TracerName(point.setting)].push_back(&point);
  const auto error_of = [&](const TradePoint& point) {
    return std::fmax(point.ErrorMm(context.measure), context.floor_mm);
  };
  std::vector<std::string> sentences;
  for (const auto& [name, own] : methods) {
    const auto on_front =
        std::find_if(own.begin(), own.end(), [](const TradePoint* p) { return p->on_time_front; });
    const TradePoint& shown = on_front != own.end() ? **on_front : *own.front();
    std::string sentence = "View " + context.view + ": " + SettingName(shown.setting);
    if (on_front != own.end()) {
      sentence += " is the cheapest for an error of " + MillimetresText(error_of(shown)) + ", at " +
                  TimeText(shown.total_ms);
    } else {
      const TradePoint* better = nullptr;
      for (const TradePoint& other : points)
        if (other.measured() && error_of(other) <= error_of(shown) && other.total_ms <= shown.total_ms &&
            &other != &shown && (better == nullptr || other.total_ms < better->total_ms))
          better = &other;
      sentence += " is never the cheapest here";
      if (better != nullptr)
        sentence += ": " + SettingName(better->setting) + " takes " + TimeText(better->total_ms) +
                    " instead of " + TimeText(shown.total_ms) + ", and its error is no larger";
    }
    if (shown.silhouette.pixels > 0)
      sentence += "; at " + std::to_string(shown.silhouette.pixels) +
                  " pixels only one of it and the certified image shows a surface";
    sentences.push_back(sentence + ".");
  }
  return sentences;
}

std::string NextViewSentence(const std::vector<TradePoint>& points, const std::vector<LimitAnswer>& answers) {
  for (const LimitAnswer& answer : answers) {
    if (!answer.mesh || !answer.direct) continue;
    const TradePoint &mesh = points[*answer.mesh], &direct = points[*answer.direct];
    return "A further view of the same model, with all that lasts at hand: " +
           TimeText(mesh.total_ms - mesh.model_ms) + " on " + SettingName(mesh.setting) + ", " +
           TimeText(direct.total_ms - direct.model_ms) + " direct, " + SettingName(direct.setting) + ".";
  }
  return "";
}

}  // namespace facetless
