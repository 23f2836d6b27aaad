// Points of speed against accuracy that are made by hand.
#pragma once

#include "render/trade/trade.h"

namespace facetless {

// One pixel is one millimetre. All statistics of the deviation are `error_mm`, except the largest, which is
// twice that.
inline TradePoint PointOf(const TradeSetting& setting, double error_mm, double ms,
                          std::uint64_t bytes = 1'000'000) {
  TradePoint point;
  point.setting = setting;
  point.deviation_mm.mean_abs = point.deviation_mm.p95 = point.deviation_mm.p99 = error_mm;
  point.deviation_mm.max = 2 * error_mm;
  point.deviation_px_scale = 1;
  point.total_ms = ms;
  point.peak_bytes = bytes;
  return point;
}

inline TradePoint MeshPoint(double deflection, double error_mm, double ms, std::uint64_t bytes = 1'000'000,
                            double angular_deg = 30) {
  return PointOf(MeshSetting{deflection, angular_deg}, error_mm, ms, bytes);
}

inline TradePoint DirectPoint(Precision precision, double error_mm, double ms,
                              std::uint64_t bytes = 1'000'000) {
  return PointOf(DirectSetting{.precision = precision}, error_mm, ms, bytes);
}

inline TradePoint Skipped(TradePoint point, const std::string& reason) {
  point.skipped = reason;
  return point;
}

}  // namespace facetless
