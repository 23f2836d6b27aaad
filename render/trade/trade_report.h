// The report of the measured points: as JSON, as a table for a terminal, and as a plot.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/trade/plot.h"
#include "render/trade/trade_answers.h"
#include "render/trade/trade_measure.h"

namespace facetless {

struct TradeView {
  TradeReference reference;
  TradeQuestionContext context;
  std::vector<TradePoint> points;
  std::vector<LimitAnswer> limits;
  std::vector<CrossoverAnswer> crossovers;
  std::vector<std::string> methods;  // MethodSentences
  std::string next_view;             // NextViewSentence
};

// Marks the fronts and computes the answers. Limits that are not given are ignored.
void AnswerQuestions(TradeView& view, const TradeLimits& limits);

// All sentences, in reading order.
std::vector<std::string> Sentences(const TradeView& view);

// One entry of the report's trade.points, with numbers in ms, mm, bytes and pixels. A point that was not
// measured has "skipped" with the reason instead.
nlohmann::json TradePointJson(const TradePoint& point, const std::string& view);
// One entry of the report's trade.answers.
nlohmann::json LimitAnswerJson(const LimitAnswer& answer, const TradeView& view);
nlohmann::json CrossoverAnswerJson(const CrossoverAnswer& answer, const TradeView& view);

// The table, with lines of at most about 110 columns.
std::string TradeTable(const TradeView& view);

LogPlot TradePlot(const TradeView& view, TradeCost cost, const std::string& model_name);

const char* MeasureName(ErrorMeasure measure);  // "mean", "p95", "p99", "max"

}  // namespace facetless
