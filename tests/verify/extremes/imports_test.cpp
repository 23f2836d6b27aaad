#include "tests/verify/extremes/imports.h"

#include <gtest/gtest.h>

namespace facetless::extremes {
namespace {

TEST(StepFileAtTheExtremes, IsRenderedRightOrRefusedByName) {
  for (const StepExtreme& extreme : StepExtremes()) {
    const StepMeasurement measured = MeasureStep(extreme);
    for (const std::string& failure : measured.failures) ADD_FAILURE() << extreme.input << ": " << failure;
  }
}

}  // namespace
}  // namespace facetless::extremes
