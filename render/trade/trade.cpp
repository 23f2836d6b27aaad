#include "render/trade/trade.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

namespace facetless {
namespace {

// Returns the shortest text that reads back as the same number, such as "1e-4", "0.003" or "12".
std::string Short(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  std::string plain = text;
  std::snprintf(text, sizeof text, "%.0e", number);
  // Write one digit and a small power of ten without the leading zero of the exponent, as in options.
  std::string power = text;
  if (std::strtod(power.c_str(), nullptr) != number || (number >= 0.1 && number < 1e4)) return plain;
  const std::size_t zero = power.find("e-0");
  if (zero != std::string::npos) power.erase(zero + 2, 1);
  return power;
}

double Pick(const Spread& spread, ErrorMeasure measure) {
  switch (measure) {
    case ErrorMeasure::kMean:
      return spread.mean_abs;
    case ErrorMeasure::kP95:
      return spread.p95;
    case ErrorMeasure::kP99:
      return spread.p99;
    case ErrorMeasure::kMax:
      break;
  }
  return spread.max;
}

void SortDescending(std::vector<double>& numbers) {
  std::sort(numbers.begin(), numbers.end(), std::greater<>());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

std::string ShortName(const DirectSetting& setting) {
  if (setting.newton_tolerance > 0) return "tol " + Short(setting.newton_tolerance);
  constexpr const char* kNames[] = {"fast", "standard", "certified"};
  return kNames[static_cast<int>(setting.precision)];
}

std::string ShortName(const MeshSetting& setting) {
  return Short(setting.deflection) + ", " + Short(setting.angular_deg) + "°";
}

std::string ShortName(const MethodChoice& choice) {
  return choice.method->setting.empty() ? choice.method->name : Short(choice.setting);
}

}  // namespace

std::string ShortSettingName(const TradeSetting& setting) {
  return std::visit([](const auto& one) { return ShortName(one); }, setting);
}

std::string SettingName(const TradeSetting& setting) {
  if (IsMesh(setting)) return "mesh " + ShortSettingName(setting);
  const auto* direct = std::get_if<DirectSetting>(&setting);
  if (direct == nullptr) return std::get<MethodChoice>(setting).Title();
  return direct->newton_tolerance > 0 ? "standard, tolerance " + Short(direct->newton_tolerance)
                                      : ShortName(*direct);
}

std::string TracerName(const TradeSetting& setting) {
  if (const auto* choice = std::get_if<MethodChoice>(&setting)) return choice->method->name;
  return IsMesh(setting) ? "mesh" : "direct";
}

double TradePoint::ErrorMm(ErrorMeasure measure) const {
  return Pick(deviation_mm, measure);
}

double TradePoint::ErrorPx(ErrorMeasure measure) const {
  return std::fmax(ErrorMm(measure) * deviation_px_scale, silhouette_offset_px);
}

double TradePointCost(const TradePoint& point, TradeCost cost) {
  return cost == TradeCost::kTime ? point.total_ms : static_cast<double>(point.peak_bytes);
}

std::vector<std::size_t> ParetoFront(const std::vector<TradePoint>& points, TradeCost cost,
                                     ErrorMeasure measure, double floor_mm) {
  const auto error_of = [&](std::size_t i) { return std::fmax(points[i].ErrorMm(measure), floor_mm); };
  const auto cost_of = [&](std::size_t i) { return TradePointCost(points[i], cost); };
  // Sort by cost. A point is then on the front if its error is smaller than those of all cheaper points.
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].measured()) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost_of(a) != cost_of(b) ? cost_of(a) < cost_of(b) : error_of(a) < error_of(b);
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    const bool equal =
        !front.empty() && cost_of(i) == cost_of(front.back()) && error_of(i) == error_of(front.back());
    if (front.empty() || error_of(i) < error_of(front.back()) || equal) front.push_back(i);
  }
  return front;
}

void MarkFronts(std::vector<TradePoint>& points, ErrorMeasure measure, double floor_mm) {
  for (TradePoint& point : points) point.on_time_front = point.on_memory_front = false;
  for (const std::size_t i : ParetoFront(points, TradeCost::kTime, measure, floor_mm))
    points[i].on_time_front = true;
  for (const std::size_t i : ParetoFront(points, TradeCost::kMemory, measure, floor_mm))
    points[i].on_memory_front = true;
}

std::vector<MeshSetting> MeshSettings(std::vector<double> deflections, std::vector<double> angles_deg) {
  // The radii, relative to the diagonal, between which a narrower angle is tried.
  constexpr double kSmallestRadius = 0.01, kLargestRadius = 1.0 / 3;
  SortDescending(deflections);
  SortDescending(angles_deg);
  std::vector<MeshSetting> settings;
  for (const double deflection : deflections)
    for (const double angle : angles_deg) {
      const double half = angle * std::numbers::pi / 360;
      const double radius = deflection / (1 - std::cos(half));
      if (angle == angles_deg.front() || (radius >= kSmallestRadius && radius <= kLargestRadius))
        settings.push_back({deflection, angle});
    }
  return settings;
}

std::vector<DirectSetting> DirectSettings(std::vector<double> tolerances) {
  SortDescending(tolerances);
  std::vector<DirectSetting> settings = {{.precision = Precision::kFast}};
  for (const double tolerance : tolerances) settings.push_back({.newton_tolerance = tolerance});
  settings.push_back({.precision = Precision::kStandard});
  settings.push_back({.precision = Precision::kCertified});
  return settings;
}

std::vector<MethodChoice> MethodSettings(const std::vector<MethodChoice>& choices) {
  std::vector<MethodChoice> settings;
  for (const MethodChoice& choice : choices) {
    if (choice.given || choice.method->setting.empty()) {
      settings.push_back(choice);
      continue;
    }
    for (const double number : choice.method->usual) settings.push_back({choice.method, number, true});
  }
  return settings;
}

bool Refines(const MeshSetting& a, const MeshSetting& b) {
  return a.deflection < b.deflection || (a.deflection == b.deflection && a.angular_deg <= b.angular_deg);
}

}  // namespace facetless
