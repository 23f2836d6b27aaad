// Numbers from repeated runs, and the order in which competitors run.
//
//  1. Competitors take turns, A B A B …, so that what else the machine does meets both.
//  2. The median stands for a series of runs: of an even number, the mean of the two in the middle.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/base/result.h"

namespace facetless {

// Requires at least one value.
double Median(std::vector<double> values);

// Of positive values; 0 if there is none.
double GeometricMean(std::span<const double> values);

// The slope of the line through (log x, log y) that least squares give: the power with which y grows with x.
// Requires two different x, all positive.
double GrowthExponent(std::span<const double> x, std::span<const double> y);

// Calls every competitor in turn, `rounds` times, and returns the times of each in ms.
std::vector<std::vector<double>> TakeTurns(int rounds, const std::vector<std::function<void()>>& competitors);

// The time of `work` in ms, by a steady clock.
double MeasureMilliseconds(const std::function<void()>& work);

}  // namespace facetless
