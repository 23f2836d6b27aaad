// The answers that follow from the measured points of a view, as numbers and as sentences.
//
//  1. Between neighbouring measured points of one series of deflections, logarithms are interpolated
//     linearly, because time and error both follow powers of the deflection. Nothing is extrapolated beyond
//     the measured range; the sentence states where it ends.
//  2. A point that was not measured is never an answer. If a finer point would be needed, the sentence names
//     it and the reason.
//  3. Sentences have two significant digits (quantity_text.h), because times on a shared machine are not more
//     accurate.
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

// The answer to "Which deflection keeps the error below the limit, and at what cost?"
struct LimitAnswer {
  bool pixels = false;  // the limit's unit: pixels, or millimetres
  double limit = 0;
  std::optional<std::size_t> mesh;    // the cheapest measured mesh that keeps the limit
  std::optional<std::size_t> direct;  // the cheapest direct setting that keeps the limit
  std::vector<std::size_t> methods;   // for each method, the cheapest setting that keeps the limit
  std::optional<double> deflection;   // the interpolated deflection at the limit, for `angular_deg`
  double angular_deg = 0;
  std::string sentence;
};
LimitAnswer AnswerLimit(const std::vector<TradePoint>& points, bool pixels, double limit,
                        const TradeQuestionContext& context);

// The answer to "From which accuracy on is the direct tracer cheaper?"
enum class Crossover : std::uint8_t {
  kUnknown,       // one of the tracers was not measured
  kAlwaysDirect,  // the direct tracer is cheaper than every measured mesh
  kAlwaysMesh,    // the mesh is cheaper in the whole measured range
  kAt,            // the direct tracer is cheaper for errors below error_mm
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

// A sentence about the cost of a further view of the same model, when mesh, tree and trimming structures
// exist already.
std::string NextViewSentence(const std::vector<TradePoint>& points, const std::vector<LimitAnswer>& answers);

// A sentence for each method: for which error it is the cheapest of all that was measured, or which setting is cheaper and
// no less accurate; and how many pixels it shows that the reference does not, or misses. Requires the marks of MarkFronts.
std::vector<std::string> MethodSentences(const std::vector<TradePoint>& points,
                                         const TradeQuestionContext& context);

// The measure in words, such as "99 % of the pixels".
const char* MeasureText(ErrorMeasure measure);

}  // namespace facetless
