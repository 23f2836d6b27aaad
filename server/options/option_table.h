// The options of a run: one table, of which the command line, --help, requests over HTTP and what makes two
// of them the same are made. openapi.json, docs/cli.md and docs/api.md are held to it by
// tests/unit/server/option_table_test.cpp. A new option is one row of AllOptions() (option_rows.cpp).
//
//  1. A name is that of JSON: the command line's without the dashes in front, and with _ for - inside:
//     --deflection-mm is "deflection_mm".
//  2. A row says who may give the option: commands by their bits, requests over HTTP unless the owner is
//     another than the caller.
//  3. Whoever uses the options takes a table, so that a test can hand in one with another row.
//
//  OptionRow row = {.name = "margin", .kind = OptionKind::kNumber, .group = "Views", .commands = kCamera, .value = "SHARE",
//                   .help = "Free share of the picture on each side", .low = 0, .high = 0.45, .usual = 0.05,
//                   .binding = Bound([](auto& o) -> auto& { return o.picture.margin; })};
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
  kFlag,     // true or false; on the command line a switch
  kInteger,  // of [low, high]
  kNumber,   // of [low, high]
  kText,     // any text that the binding understands
  kChoice,   // one of `choices`
  kWords,    // a list of words; of `choices` where there are any
  kNumbers,  // a list of numbers of [low, high], or text with commas
  kJson,     // what the binding understands, of the types that `json_types` lists
};

// Commands of the command line, as bits.
using Commands = unsigned;
inline constexpr Commands kInspect = 1, kContinuity = 2, kRender = 4, kMesh = 8, kCompare = 16, kTrade = 32,
                          kBench = 64, kRegress = 128;
// An entry of a manifest of regress, which is no command: it says how one file is rendered.
inline constexpr Commands kManifest = 256;

enum class OptionOwner {
  kCaller,    // the command line, and requests over HTTP
  kOperator,  // concerns the machine: of requests over HTTP the operator of the service sets it
  kPart,      // of requests over HTTP it is a part of the body
};

// How the value of an option gets into the options, and out of them.
struct OptionBinding {
  // Error: kBadUsage names the option and what is allowed.
  std::function<Result<void>(const OptionRow& row, const nlohmann::json& value, RunOptions& options)> store;
  // What the options hold, in one form however it was written: two values that mean the same are equal.
  std::function<nlohmann::json(const OptionRow& row, const RunOptions& options)> read;
};

struct OptionRow {
  std::string name;
  OptionKind kind = OptionKind::kFlag;
  std::string group;  // the heading over it in --help and docs/cli.md
  Commands commands = 0;
  std::string value;                // what stands for the value in --help; empty: a flag
  std::string help;                 // without range, choices and default
  double low = 0, high = INFINITY;  // a smallest normal double stands for "more than 0"
  std::vector<std::string> choices = {};
  nlohmann::json usual = nullptr;  // the default; null: none, or one that only `usual_words` can say
  std::string usual_words = "";    // "the file's own"
  OptionOwner owner = OptionOwner::kCaller;
  std::vector<std::string> excludes = {};
  std::vector<std::string> json_types =
      {};                   // of kJson, and of kText that may be more: "string", "object", "array", "number"
  bool repeatable = false;  // on the command line it may be given several times
  OptionBinding binding = {};
};

using OptionTable = std::vector<OptionRow>;

const OptionTable& AllOptions();

// A name as JSON has it, of one in which - stands for _.
std::string OptionName(std::string_view written);
// The option that is written so; null if there is none.
const OptionRow* FindOption(std::string_view written, const OptionTable& table = AllOptions());
std::vector<std::string> OptionNames(const OptionTable& table = AllOptions());
// "--deflection-mm".
std::string FlagOf(const OptionRow& row);

// "0 … 0.45", "at least 0", "more than 0"; "" where the kind has no range.
std::string RangeText(const OptionRow& row);
// "0.05", "1e-2,1e-3", "the file's own"; "" where there is none.
std::string UsualText(const OptionRow& row);
// "Free share of the picture on each side (0 … 0.45; default: 0.05)".
std::string HelpText(const OptionRow& row);
// The row of the table in docs/api.md, for an option that requests to `collections` take: "| `margin` | number,
// 0 … 0.45 | 0.05 | renders, comparisons, trades |".
std::string ApiRow(const OptionRow& row, const std::vector<std::string>& collections);

}  // namespace facetless
