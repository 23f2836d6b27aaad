// Extremes that a file can hold: written as STEP, read by facetless-import, rendered.
//
//  1. Each file is one B-spline face between four edges. Either the face arrives and its samples pass what
//     Measure asks, or the answer names what is wrong: an error of the importer, or a lost face with its
//     reason.
#pragma once

#include <string>
#include <vector>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {

enum class Arrival : std::uint8_t { kRendered, kRefused };

struct StepExtreme {
  std::string input, expected;
  std::string text;
  Arrival arrival = Arrival::kRendered;
};

struct StepMeasurement {
  std::string refusal;      // empty: the face arrived
  Measurement measurement;  // where it did
  std::vector<std::string> failures;
};

std::vector<StepExtreme> StepExtremes();
StepMeasurement MeasureStep(const StepExtreme& extreme);

}  // namespace facetless::extremes
