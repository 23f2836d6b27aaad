// The option table: all options of a run. The command line, --help, HTTP requests and the comparison of
// requests are derived from it. tests/unit/server/option_table_test.cpp checks openapi.json, docs/cli.md and
// docs/api.md against it. To add an option, add a row to AllOptions() (option_rows.cpp).
//
//  1. The name of an option is its JSON name: the command-line name without the leading dashes and with _
//     instead of -, so --deflection-mm is "deflection_mm".
//  2. A row states where the option is accepted: by the commands in `commands`, and in HTTP requests if the
//     owner is kCaller.
//  3. Functions that use the options take a table as an argument, so that a test can pass a table with
//     another row.
//
//     OptionRow row = {.name = "margin", .kind = OptionKind::kNumber, .group = "Views", .commands = kCamera,
//                      .value = "SHARE", .help = "Margin on each side, as a share of the picture",
//                      .low = 0, .high = 0.45, .usual = 0.05,
//                      .binding = Bound([](auto& o) -> auto& { return o.picture.margin; })};
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"

namespace facetless {

struct RunOptions;
struct OptionRow;

enum class OptionKind {
  kFlag,     // true or false; a switch on the command line
  kInteger,  // an integer in [low, high]
  kNumber,   // a number in [low, high]
  kText,     // any text that the binding accepts
  kChoice,   // one of `choices`
  kWords,    // a list of words, from `choices` if that is not empty
  kNumbers,  // a list of numbers in [low, high], or text with commas
  kJson,     // any value that the binding accepts, of the types in `json_types`
};

// A set of commands, as bits.
using Commands = unsigned;
inline constexpr Commands kInspect = 1, kContinuity = 2, kRender = 4, kMesh = 8, kCompare = 16, kTrade = 32,
                          kBench = 64, kRegress = 128, kMethods = 512, kVoxelize = 1024, kConvert = 2048;
// Entries of a manifest of regress, which say how one file is rendered. This is no command, but entries take
// options, too.
inline constexpr Commands kManifest = 256;

enum class OptionOwner {
  kCaller,       // the option is accepted on the command line and in HTTP requests
  kOperator,     // the option concerns the machine; the operator of the service sets it for HTTP requests
  kPart,         // in HTTP requests, it is a part of the multipart body
  kCommandLine,  // the option belongs to a command that the service does not have
};

// Stores the value of an option in RunOptions, and reads it back.
struct OptionBinding {
  // Stores a value. Error: kBadUsage, which names the option and what is allowed.
  std::function<Result<void>(const OptionRow& row, const nlohmann::json& value, RunOptions& options)> store;
  // Reads the value in a canonical form: values with the same meaning are equal, however they were written.
  std::function<nlohmann::json(const OptionRow& row, const RunOptions& options)> read;
};

struct OptionRow {
  std::string name;
  OptionKind kind = OptionKind::kFlag;
  std::string group;  // the heading of the option in --help and docs/cli.md
  Commands commands = 0;
  std::string value;                // placeholder for the value in --help; empty for a flag
  std::string help;                 // help text without range, choices and default
  double low = 0, high = INFINITY;  // the smallest normal double as `low` means "more than 0"
  std::vector<std::string> choices = {};
  nlohmann::json usual = nullptr;  // the default; null: there is none, or `usual_words` describes it
  std::string usual_words = "";    // "the file's own"
  OptionOwner owner = OptionOwner::kCaller;
  std::vector<std::string> excludes = {};
  std::vector<std::string> json_types =
      {};  // types for kJson, and for kText that accepts other types: "string", "object", "array", "number"
  bool repeatable = false;  // the option may be given several times on the command line
  OptionBinding binding = {};
};

using OptionTable = std::vector<OptionRow>;

const OptionTable& AllOptions();

// The JSON name that corresponds to a name written with - instead of _.
std::string OptionName(std::string_view written);
// The option with the written name; null if there is none.
const OptionRow* FindOption(std::string_view written, const OptionTable& table = AllOptions());
std::vector<std::string> OptionNames(const OptionTable& table = AllOptions());
// The command-line form of the name, such as "--deflection-mm".
std::string CommandLineName(const OptionRow& row);

// The range, such as "0 … 0.45", "at least 0" or "more than 0"; "" if the kind has no range.
std::string RangeText(const OptionRow& row);
// The default, such as "0.05", "1e-2,1e-3" or "the file's own"; "" if there is none.
std::string UsualText(const OptionRow& row);
// The full help text: "Margin on each side, as a share of the picture (0 … 0.45; default: 0.05)".
std::string HelpText(const OptionRow& row);
// The row of the table in docs/api.md for an option that requests to `collections` accept, such as "|
// `margin` | number, 0 … 0.45 | 0.05 | renders, comparisons, trades |".
std::string ApiRow(const OptionRow& row, const std::vector<std::string>& collections);

}  // namespace facetless
