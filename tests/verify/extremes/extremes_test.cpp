// Checks every row of the table of extremes (docs/accuracy-results.md, "Extremes").
#include <gtest/gtest.h>

#include <cctype>

#include "tests/verify/extremes/extreme.h"

namespace facetless::extremes {
namespace {

class Extremes : public ::testing::TestWithParam<Extreme> {};

TEST_P(Extremes, Holds) {
  const Measurement measurement = Measure(GetParam());
  for (const std::string& failure : measurement.failures) ADD_FAILURE() << failure;
}

std::vector<Extreme> RowsForTests() {
  std::vector<Extreme> rows;
  for (const Extreme& extreme : Catalogue())
    if (!extreme.by_hand) rows.push_back(extreme);
  return rows;
}

std::string RowName(const ::testing::TestParamInfo<Extreme>& info) {
  std::string name;
  for (const char c : info.param.group + " " + info.param.input) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  return name + "_" + std::to_string(info.index);
}

INSTANTIATE_TEST_SUITE_P(Every, Extremes, ::testing::ValuesIn(RowsForTests()), RowName);

}  // namespace
}  // namespace facetless::extremes
