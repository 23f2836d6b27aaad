// Extremes that a file can contain: they are written as STEP, read by facetless-import, and rendered.
//
//  1. Each file is one B-spline face between four edges. Either the face is imported and its samples pass the
//     checks of Measure, or the answer says what is wrong: an error of the importer, or a lost face with its
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
  std::string refusal;      // empty: the face was imported
  Measurement measurement;  // of an imported face
  std::vector<std::string> failures;
};

std::vector<StepExtreme> StepExtremes();
StepMeasurement MeasureStep(const StepExtreme& extreme);

}  // namespace facetless::extremes
