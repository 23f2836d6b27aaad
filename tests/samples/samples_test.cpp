// The program's answer about every sample, against samples/expected.json.
//
//  1. `facetless inspect` counts the faces, solids and kinds of surface that the file was made with.
//  2. The model's bounds hold the shape's extent, and are not much wider.
//  3. A broken file gives its exit code, and no report of success.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/samples/program.h"

namespace facetless {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path SamplesFolder() {
  const char* root = std::getenv("FACETLESS_SOURCE");
  return fs::path(root != nullptr ? root : ".") / "samples";
}

json Expected() {
  return json::parse(std::ifstream(SamplesFolder() / "expected.json"));
}

std::vector<std::string> SampleNames() {
  std::vector<std::string> names;
  std::ifstream file(SamplesFolder() / "expected.json");
  // Listed when the program is loaded, so a missing file must not throw here: TheListIsThere says it.
  const json expected = json::parse(file, nullptr, false);
  for (const auto& [name, value] : expected.items()) names.push_back(name);
  return names;
}

TEST(Samples, TheListIsThere) {
  EXPECT_GE(SampleNames().size(), 15u);
}

class Sample : public testing::TestWithParam<std::string> {};

TEST_P(Sample, InspectAgreesWithWhatWasMade) {
  const json expected = Expected()[GetParam()];
  const ProgramResult inspected =
      RunProgram("facetless inspect '" + (SamplesFolder() / GetParam()).string() + "'");
  ASSERT_EQ(inspected.exit_code, expected["exit"].get<int>()) << inspected.output;
  if (!expected.contains("faces")) return;

  const json model = json::parse(inspected.output)["model"];
  EXPECT_EQ(model["faces"], expected["faces"]);
  EXPECT_EQ(model["solids"], expected["solids"]);
  EXPECT_EQ(model["surfaces"], expected["surfaces"]);
  EXPECT_EQ(model["faces_skipped"], json::array());
  EXPECT_EQ(model["loops_lost"], json::array());

  // The bounds are conservative: as large as the shape, and at most a tenth of its diagonal larger.
  const double slack = 0.1 * model["diagonal_mm"].get<double>();
  // What the file's decimal digits and OpenCASCADE's own bounding box leave unsure.
  const double noise = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = model["bounds_mm"][0][axis], high = model["bounds_mm"][1][axis];
    const double expected_low = expected["bounds_mm"][0][axis],
                 expected_high = expected["bounds_mm"][1][axis];
    EXPECT_LE(low, expected_low + noise);
    EXPECT_GE(low, expected_low - slack);
    EXPECT_GE(high, expected_high - noise);
    EXPECT_LE(high, expected_high + slack);
  }
}

std::string TestName(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Sample, testing::ValuesIn(SampleNames()), TestName);

}  // namespace
}  // namespace facetless
