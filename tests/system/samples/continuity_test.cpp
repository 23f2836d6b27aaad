// Tests that `facetless continuity` finds the breaks with which the vase was made in its STEP file.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/system/samples/program.h"
#include "tests/system/samples/samples.h"

namespace facetless {
namespace {

TEST(Continuity, OfTheVaseIsWhatItWasMadeWith) {
  const ProgramResult result = RunProgram("facetless continuity '" + Sample("vase.step") + "' 2> /dev/null");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const nlohmann::json continuity = nlohmann::json::parse(result.output).at("continuity");
  EXPECT_EQ(continuity["counts"]["gap"], 0);
  EXPECT_EQ(continuity["counts"]["G0"], 3);
  EXPECT_EQ(continuity["counts"]["G1"], 1);
  EXPECT_EQ(continuity["counts"]["G2"], 5) << "the neck, and the seams of four faces";
  // These are the groove, and the belly where the radii 25 and 12 meet. A STEP file has 15 digits.
  EXPECT_NEAR(continuity["worst"]["G0"][2]["angle_deg"].get<double>(), 8, 1e-9);
  const nlohmann::json& belly = continuity["worst"]["G1"][0];
  EXPECT_NEAR(belly["curvature_jump"].get<double>(), 1.0 / 12 - 1.0 / 25, 1e-12);
  EXPECT_NEAR(belly["gap_at"][2].get<double>(), 20, 1e-9);
}

}  // namespace
}  // namespace facetless
