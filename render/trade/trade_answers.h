// What the measured points of a view answer, as numbers and as sentences.
//
//  1. Between neighbouring measured points of one ladder, logarithms are interpolated linearly: time and
//     error both follow powers of the deflection. Beyond the measured range nothing is extrapolated; the
//     sentence says where it ends.
//  2. A point that was not measured is no answer, but is named with its reason where a finer one was asked
//     for.
//  3. Sentences give two significant digits (quantity_text.h): times on a shared machine are not known
//     better.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/trade/trade.h"

namespace facetless {

struct TradeLimits {
  std::optional<double> error_mm, error_px;
};

struct TradeQuestionContext {
  std::string view;
  ErrorMeasure measure = ErrorMeasure::kP99;
  double floor_mm = 0;
  double mm_per_pixel = 0;
};

// "Which deflection keeps this model under the limit, and what does it cost?"
struct LimitAnswer {
  bool pixels = false;  // the limit's unit: pixels, or millimetres
  double limit = 0;
  std::optional<std::size_t> mesh;    // the cheapest mesh measured that keeps it
  std::optional<std::size_t> direct;  // the cheapest direct setting that keeps it
  std::vector<std::size_t> methods;   // of each method, the cheapest setting that keeps it
  std::optional<double> deflection;   // where the ladder crosses the limit, interpolated; for `angular_deg`
  double angular_deg = 0;
  std::string sentence;
};
LimitAnswer AnswerLimit(const std::vector<TradePoint>& points, bool pixels, double limit,
                        const TradeQuestionContext& context);

// "From which accuracy on is direct cheaper?"
enum class Crossover : std::uint8_t {
  kUnknown,       // nothing of one of the tracers was measured
  kAlwaysDirect,  // cheaper than every mesh measured
  kAlwaysMesh,    // the mesh is cheaper, as far as it was measured
  kAt,            // direct is cheaper where errors below error_mm are asked for
};
struct CrossoverAnswer {
  TradeCost cost = TradeCost::kTime;
  Crossover kind = Crossover::kUnknown;
  std::optional<double> error_mm;             // kAt
  std::optional<double> finest_mm;            // the smallest error that a mesh reached
  std::optional<std::size_t> coarser, finer;  // kAt: the meshes that error_mm lies between
  std::string sentence;
};
CrossoverAnswer AnswerCrossover(const std::vector<TradePoint>& points, TradeCost cost,
                                const TradeQuestionContext& context);

// What a further view of the same model costs, where mesh, tree and trimming structures exist already.
std::string NextViewSentence(const std::vector<TradePoint>& points, const std::vector<LimitAnswer>& answers);

// "99 % of the pixels" and so on.
const char* MeasureText(ErrorMeasure measure);

}  // namespace facetless
