// Tests what the command line reports for files that lose something: exit codes, and numbers that add up.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/files.h"
#include "tests/system/samples/program.h"

namespace facetless {
namespace {

using nlohmann::json;

struct Answer {
  int exit_code;
  json model;
};

Answer Inspect(const std::string& path, const std::string& options = "") {
  const ProgramResult result = RunProgram("facetless inspect '" + path + "' " + options + " 2>&1");
  const json report = json::parse(result.output, nullptr, false);
  return {result.exit_code, report.is_object() ? report.at("model") : json(result.output)};
}

class LedgerOfLosses : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(LedgerOfLosses, AddsUp) {
  const auto [file, exit_code] = GetParam();
  const std::string path = CadFile(std::string("cases/") + file);
  if (path.empty()) GTEST_SKIP() << "FACETLESS_CAD names no folder with " << file << ", which is not tested";
  const Answer answer = Inspect(path);
  EXPECT_EQ(answer.exit_code, exit_code) << answer.model;
  if (exit_code > 1) return;
  const json& model = answer.model;
  EXPECT_EQ(model.at("faces_declared").get<std::size_t>(),
            model.at("faces_shown").get<std::size_t>() + model.at("faces_skipped").size());
  // If the two numbers differ, a note must say why.
  EXPECT_EQ(model.at("faces_note").is_null(), model.at("faces") == model.at("faces_declared"));
  if (exit_code == 1) {
    EXPECT_EQ(Inspect(path, "--strict").exit_code, 2);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, LedgerOfLosses,
    ::testing::Values(std::pair{"base.stp", 0}, std::pair{"asm_two.stp", 0},
                      std::pair{"mapped_scale2.step", 0}, std::pair{"brep_and_csg.step", 1},
                      std::pair{"concat.stp", 1}, std::pair{"asm_second_no_transform.stp", 1},
                      std::pair{"loop_in_shell.stp", 1}, std::pair{"geometric_set_one_lost.step", 1},
                      std::pair{"open3.stp", 1}, std::pair{"dollar_cone_declared_rad_written_deg.step", 1},
                      std::pair{"cone_declared_deg_written_rad.step", 1}, std::pair{"oneline.stp", 4}),
    [](const auto& info) {
      std::string name = info.param.first;
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

TEST(LengthUnit, ThatIsMissingIsSaidAndFailsUnderStrict) {
  const std::string path = CadFile("cases/u_none.stp");
  if (path.empty()) GTEST_SKIP() << "FACETLESS_CAD names no folder with u_none.stp, which is not tested";
  const Answer answer = Inspect(path);
  EXPECT_EQ(answer.exit_code, 0);
  EXPECT_EQ(answer.model.at("unit"), "");
  EXPECT_NE(answer.model.at("warnings").dump().find("no length unit"), std::string::npos);
  EXPECT_EQ(Inspect(path, "--strict").exit_code, 2);
  // If the unit is given by hand, it is known.
  const Answer given = Inspect(path, "--strict --unit in");
  EXPECT_EQ(given.exit_code, 0);
  EXPECT_EQ(given.model.at("unit"), "inch");
  EXPECT_DOUBLE_EQ(given.model.at("bounds_mm")[1][0].get<double>(), 25.4);
}

TEST(LengthUnit, OfTheCommandLineOverridesTheFiles) {
  for (const auto& [unit, mm] : {std::pair{"in", 25.4}, {"cm", 10.0}, {"2.5", 2.5}}) {
    const Answer own = Inspect(Sample("bracket.step"));
    const Answer given = Inspect(Sample("bracket.step"), std::string("--unit ") + unit);
    EXPECT_EQ(given.exit_code, 0);
    EXPECT_NEAR(given.model.at("diagonal_mm").get<double>(), mm * own.model.at("diagonal_mm").get<double>(),
                1e-9 * given.model.at("diagonal_mm").get<double>());
    EXPECT_EQ(given.model.at("unit_mm"), mm);
    EXPECT_EQ(given.model.at("faces"), own.model.at("faces"));
  }
  // The same applies to IGES.
  const Answer own = Inspect(Sample("trimmed.iges")), given = Inspect(Sample("trimmed.iges"), "--unit m");
  EXPECT_NEAR(given.model.at("diagonal_mm").get<double>() / own.model.at("diagonal_mm").get<double>(),
              1000 / own.model.at("unit_mm").get<double>(), 1e-6);
  EXPECT_EQ(Inspect(Sample("bracket.step"), "--unit parsec").exit_code, 64);
}

}  // namespace
}  // namespace facetless
