#include "bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/base/stopwatch.h"

namespace facetless {

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double MedianRatio(const std::vector<double>& values, const std::vector<double>& others) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < values.size(); ++i) ratios.push_back(values[i] / others[i]);
  return Median(std::move(ratios));
}

double GeometricMean(std::span<const double> values) {
  if (values.empty()) return 0;
  double sum = 0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

double GrowthExponent(std::span<const double> x, std::span<const double> y) {
  double mean_x = 0, mean_y = 0;
  const double count = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / count;
    mean_y += std::log(y[i]) / count;
  }
  double covariance = 0, variance = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x;
    covariance += dx * (std::log(y[i]) - mean_y);
    variance += dx * dx;
  }
  return covariance / variance;
}

std::vector<std::vector<double>> TakeTurns(int rounds,
                                           const std::vector<std::function<void()>>& competitors) {
  std::vector<std::vector<double>> times(competitors.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < competitors.size(); ++i)
      times[i].push_back(MeasureMilliseconds(competitors[i]));
  return times;
}

double MeasureMilliseconds(const std::function<void()>& work) {
  const Stopwatch stopwatch;
  work();
  return stopwatch.Milliseconds();
}

}  // namespace facetless
