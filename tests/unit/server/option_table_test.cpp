// One row of the option table makes an option available everywhere: on the command line, in --help and in
// requests. openapi.json and the documentation are checked against it.
#include "server/options/option_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <set>

#include "server/command/cli_options.h"
#include "server/options/option_binding.h"
#include "server/service/jobs/job_kinds.h"
#include "tests/unit/server/option_checks.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::pair<Commands, const char*> kCommandNames[] = {
    {kInspect, "inspect"}, {kContinuity, "continuity"}, {kRender, "render"}, {kMesh, "mesh"},
    {kCompare, "compare"}, {kTrade, "trade"},           {kBench, "bench"},   {kRegress, "regress"}};

Json OpenApiProperties() {
  return Json::parse(
      ReadText(SourceRoot() / "server/web/openapi.json"))["components"]["schemas"]["Options"]["properties"];
}
std::string CliDocs() {
  return ReadText(SourceRoot() / "docs/cli.md");
}
std::string ApiDocs() {
  return ReadText(SourceRoot() / "docs/api.md");
}

// Returns the command's --help for the options of `table` alone.
std::string PrintedHelp(Commands command, const OptionTable& table) {
  CLI::App app;
  OptionCollector collected;
  AddOptions(&app, command, collected, table);
  return app.help();
}

// Returns what the command line `words` passes to ParseOptions.
Json CollectedFrom(Commands command, std::vector<std::string> words, const OptionTable& table) {
  CLI::App app;
  OptionCollector collected;
  AddOptions(&app, command, collected, table);
  std::reverse(words.begin(), words.end());  // CLI11 requires the reverse order
  app.parse(words);
  return collected.CollectedOptions().value();
}

// The normal table with one additional option.
OptionTable WithGain() {
  OptionTable table = AllOptions();
  table.push_back({.name = "gain_factor",
                   .kind = OptionKind::kNumber,
                   .group = "Pictures",
                   .commands = kRender | kCompare,
                   .value = "GAIN",
                   .help = "Multiplies what pictures show",
                   .low = 1,
                   .high = 8,
                   .usual = 2,
                   .excludes = {"edges"},
                   .binding = Bound([](auto& o) -> auto& { return o.picture.turntable_s; })});
  return table;
}

TEST(OptionTable, HasSoundRows) {
  std::set<std::string> names;
  for (const OptionRow& row : AllOptions()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name << " occurs twice";
    EXPECT_NE(row.commands, 0u) << row.name;
    EXPECT_FALSE(row.help.empty() || row.help.ends_with(".")) << row.name;
    EXPECT_EQ(row.value.empty(), row.kind == OptionKind::kFlag) << row.name;
    EXPECT_LT(row.low, row.high) << row.name;
    EXPECT_FALSE(row.kind == OptionKind::kChoice && row.choices.empty()) << row.name;
    EXPECT_FALSE(row.kind == OptionKind::kJson && row.json_types.empty()) << row.name;
    for (const std::string& other : row.excludes)
      EXPECT_NE(FindOption(other), nullptr) << row.name << ", " << other;
  }
}

TEST(OptionTable, SaysTheDefaultsThatTheOptionsHave) {
  const RunOptions defaults;
  for (const OptionRow& row : AllOptions()) {
    if (row.usual.is_null()) continue;
    RunOptions options;
    ASSERT_TRUE(row.binding.store(row, row.usual, options).ok()) << row.name;
    EXPECT_EQ(row.binding.read(row, options), row.binding.read(row, defaults)) << row.name;
  }
}

TEST(OptionTable, ReadsBackWhatIsStored) {
  for (const OptionRow& row : AllOptions()) {
    const RunOptions defaults;
    Json other;
    if (row.kind == OptionKind::kFlag) other = true;
    if (row.kind == OptionKind::kChoice) other = row.choices[row.choices.front() == row.usual ? 1 : 0];
    if (row.kind == OptionKind::kNumber || row.kind == OptionKind::kInteger)
      other = std::isinf(row.high) ? 12345.0 : row.high;
    if (row.kind == OptionKind::kNumbers) other = Json::array({row.high, row.low});
    if (other.is_null()) continue;  // the option has a form of its own
    RunOptions options;
    ASSERT_TRUE(row.binding.store(row, other, options).ok()) << row.name;
    EXPECT_EQ(row.binding.read(row, options), other) << row.name;
    EXPECT_NE(row.binding.read(row, defaults), other) << row.name;
  }
}

TEST(OptionTable, RangesHoldAtBothEnds) {
  for (const OptionRow& row : AllOptions()) {
    if (row.kind != OptionKind::kNumber && row.kind != OptionKind::kInteger &&
        row.kind != OptionKind::kNumbers)
      continue;
    RunOptions options;
    EXPECT_TRUE(row.binding.store(row, row.low, options).ok()) << row.name;
    const auto below = row.binding.store(row, row.low > 0 ? row.low / 2 : 2 * row.low - 1, options);
    ASSERT_FALSE(below.ok()) << row.name;
    EXPECT_THAT(below.error().message, HasSubstr(row.name));
    if (!std::isinf(row.high)) {
      EXPECT_TRUE(row.binding.store(row, row.high, options).ok()) << row.name;
      EXPECT_FALSE(row.binding.store(row, row.high * 2, options).ok()) << row.name;
    }
  }
}

TEST(OptionTable, IsTheHelpOfEveryCommand) {
  for (const auto& [command, name] : kCommandNames) {
    const ChildOutcome printed = RunProgram(Program("facetless"), {name, "--help"}, "/");
    for (const OptionRow& row : AllOptions()) {
      const std::string line = CommandLineName(row) + (row.value.empty() ? "" : " " + row.value) + " ";
      if ((row.commands & command) != 0) {
        EXPECT_THAT(printed.out, HasSubstr(line)) << name;
        EXPECT_THAT(printed.out, HasSubstr(HelpText(row))) << name;
        EXPECT_THAT(printed.out, HasSubstr("\n" + row.group + ":\n")) << name;
      } else {
        EXPECT_THAT(printed.out, Not(HasSubstr("\n  " + line))) << name << " takes no " << row.name;
      }
    }
  }
}

TEST(OptionTable, IsWhatOpenApiSays) {
  EXPECT_THAT(SchemaDifferences(AllOptions(), OpenApiProperties()), IsEmpty());
}

TEST(OptionTable, IsWhatTheDocumentationSays) {
  EXPECT_THAT(CliDocsDifferences(AllOptions(), CliDocs()), IsEmpty());
  EXPECT_THAT(ApiDocsDifferences(AllOptions(), ApiDocs()), IsEmpty());
}

TEST(OptionTable, OneMoreRowIsOneMoreOptionEverywhere) {
  const OptionTable table = WithGain();
  const OptionRow& row = table.back();
  // The option must appear in --help.
  EXPECT_THAT(PrintedHelp(kRender, table), HasSubstr("--gain-factor GAIN"));
  EXPECT_THAT(PrintedHelp(kRender, table), HasSubstr("Multiplies what pictures show (1 … 8; default: 2)"));
  EXPECT_THAT(PrintedHelp(kTrade, table), Not(HasSubstr("--gain-factor")));
  EXPECT_THAT(PrintedHelp(kRender, AllOptions()), Not(HasSubstr("--gain-factor")));
  // The command line must accept the option.
  const Json collected = CollectedFrom(kCompare, {"--gain-factor", "3"}, table);
  EXPECT_EQ(collected, Json({{"gain_factor", 3.0}}));
  EXPECT_THROW(CollectedFrom(kTrade, {"--gain-factor", "3"}, table), CLI::ParseError);
  // Requests must accept the option.
  const auto options = ParseOptions(collected, table);
  ASSERT_TRUE(options.ok()) << options.error().message;
  EXPECT_EQ(row.binding.read(row, options.value()), 3.0);
  EXPECT_THAT(ParseOptions({{"gain-factor", 9}}, table).error().message,
              HasSubstr("gain_factor is 9, but must be a number from 1 to 8"));
  EXPECT_THAT(ParseOptions({{"gain_factor", 3}, {"edges", true}}, table).error().message,
              HasSubstr("give either gain_factor or edges"));
  EXPECT_THAT(ParseOptions({{"gain_facto", 3}}, table).error().message,
              HasSubstr("did you mean gain_factor?"));
  EXPECT_FALSE(ParseOptions(collected).ok()) << "the normal table has no such option";
  EXPECT_THAT(CollectionsOf(row), ElementsAre("renders", "comparisons"));
  // Texts that are not written yet must be reported as missing, by name.
  EXPECT_THAT(SchemaDifferences(table, OpenApiProperties()),
              ElementsAre(HasSubstr("openapi.json lacks gain_factor")));
  EXPECT_THAT(CliDocsDifferences(table, CliDocs()),
              ElementsAre(HasSubstr("0 rows of gain_factor under \"Pictures\"")));
  EXPECT_THAT(ApiDocsDifferences(table, ApiDocs()), ElementsAre(HasSubstr("| `gain_factor` |")));
  // Once they are written, nothing must be reported.
  Json properties = OpenApiProperties();
  properties["gain_factor"] = {{"type", "number"}, {"minimum", 1}, {"maximum", 8}, {"default", 2}};
  EXPECT_THAT(SchemaDifferences(table, properties), IsEmpty());
  EXPECT_THAT(
      CliDocsDifferences(table, CliDocs() + "\n## Pictures\n\n| `--gain-factor GAIN` | 1 … 8 | 2 |\n"),
      IsEmpty());
  std::string api = ApiDocs();
  const std::size_t last = api.find("| `unit` |");
  ASSERT_NE(last, std::string::npos);
  api.insert(api.find('\n', last) + 1, ApiRow(row, CollectionsOf(row)) + "\n");
  EXPECT_THAT(ApiDocsDifferences(table, api), IsEmpty());
}

TEST(OptionTable, WhatIsWrittenWronglyIsFound) {
  // Remove a row: the texts about it then have no option.
  OptionTable table = AllOptions();
  std::erase_if(table, [](const OptionRow& row) { return row.name == "newton_tolerance"; });
  EXPECT_THAT(SchemaDifferences(table, OpenApiProperties()),
              ElementsAre(HasSubstr("has newton_tolerance, which is no option")));
  EXPECT_THAT(CliDocsDifferences(table, CliDocs()), ElementsAre(HasSubstr("has --newton-tolerance")));
  EXPECT_THAT(ApiDocsDifferences(table, ApiDocs()), ElementsAre(HasSubstr("`newton_tolerance`")));
  // Change the range, default, choice, value or group.
  const auto changed = [](const char* name, const std::function<void(OptionRow&)>& change) {
    OptionTable other = AllOptions();
    for (OptionRow& row : other)
      if (row.name == name) change(row);
    std::vector<std::string> differences = SchemaDifferences(other, OpenApiProperties());
    for (const auto& more : {CliDocsDifferences(other, CliDocs()), ApiDocsDifferences(other, ApiDocs())})
      differences.insert(differences.end(), more.begin(), more.end());
    return differences;
  };
  EXPECT_THAT(changed("margin", [](OptionRow& row) { row.high = 0.4; }),
              Contains(HasSubstr("margin lacks its range, 0 … 0.4")));
  EXPECT_THAT(changed("margin", [](OptionRow& row) { row.usual = 0.1; }), Contains(HasSubstr("not \"0.1\"")));
  EXPECT_THAT(changed("lines", [](OptionRow& row) { row.choices.push_back("dotted"); }),
              Contains(HasSubstr("lines lacks its choice dotted")));
  EXPECT_THAT(changed("lines", [](OptionRow& row) { row.value = "MODE"; }),
              ElementsAre(HasSubstr("not `--lines MODE`")));
  EXPECT_THAT(changed("lines", [](OptionRow& row) { row.kind = OptionKind::kText; }),
              Contains(HasSubstr("openapi.json says of lines")));
  EXPECT_THAT(changed("lines", [](OptionRow& row) { row.group = "Meshes"; }),
              Contains(HasSubstr("0 rows of lines under \"Meshes\"")));
  EXPECT_THAT(changed("lines", [](OptionRow& row) { row.owner = OptionOwner::kOperator; }),
              Contains(HasSubstr("has lines, which is no option of requests")));
}

}  // namespace
}  // namespace facetless
