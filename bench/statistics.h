// Statistics of repeated runs, and the order in which competitors run.
//
//  1. Competitors take turns, A B A B …, so that other work on the machine affects all of them.
//  2. The median represents a series of runs. For an even number of runs, it is the mean of the two in the
//     middle.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/base/result.h"

namespace facetless {

// Requires at least one value.
double Median(std::vector<double> values);

// Returns the median of the ratios of each turn. Requires as many values on both sides, and at least one.
double MedianRatio(const std::vector<double>& values, const std::vector<double>& others);

// Returns the geometric mean of positive values; 0 if there are none.
double GeometricMean(std::span<const double> values);

// Returns the exponent with which y grows with x: the slope of the least-squares line through (log x, log y).
// Requires two different x; all values must be positive.
double GrowthExponent(std::span<const double> x, std::span<const double> y);

// Calls every competitor in turn, `rounds` times, and returns the times of each in ms.
std::vector<std::vector<double>> TakeTurns(int rounds, const std::vector<std::function<void()>>& competitors);

// Returns the time of `work` in ms, measured with a steady clock.
double MeasureMilliseconds(const std::function<void()>& work);

}  // namespace facetless
