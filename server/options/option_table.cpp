#include "server/options/option_table.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "server/options/option_values.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// A number in the usual notation: 0.45, 65536, 1e-3, 1e9.
std::string NumberText(double number) {
  char text[40];
  const double size = std::fabs(number);
  if (size == 0 || (size > 0.01 && size < 1e6)) {
    std::snprintf(text, sizeof text, "%.15g", number);
    return text;
  }
  int exponent = static_cast<int>(std::floor(std::log10(size)));
  std::snprintf(text, sizeof text, "%.12ge%d", number / std::pow(10, exponent), exponent);
  return text;
}

std::string ValueText(const Json& value) {
  if (value.is_number()) return NumberText(value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  std::string text;
  for (const Json& entry : value) text += (text.empty() ? "" : ",") + ValueText(entry);
  return text;
}

bool HasRange(OptionKind kind) {
  return kind == OptionKind::kInteger || kind == OptionKind::kNumber || kind == OptionKind::kNumbers;
}

// The words as "a, b or c".
std::string Alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

// The kind in words, with range or choices.
std::string TypeText(const OptionRow& row) {
  std::vector<std::string> choices;
  for (const std::string& choice : row.choices) choices.push_back("`" + choice + "`");
  const std::string range = RangeText(row).empty() ? "" : ", " + RangeText(row);
  switch (row.kind) {
    case OptionKind::kFlag:
      return "`true` or `false`";
    case OptionKind::kInteger:
      return "whole number" + range;
    case OptionKind::kNumber:
      return "number" + range;
    case OptionKind::kChoice:
      return Alternatives(choices);
    case OptionKind::kWords:
      return choices.empty() ? "list of texts" : "list of " + Joined(choices);
    case OptionKind::kNumbers:
      return "list of numbers" + range;
    default: {
      std::vector<std::string> types;
      for (const std::string& type : row.json_types)
        types.push_back(type == "string" ? "text" : type == "array" ? "list" : type);
      return types.empty() ? "text" : Alternatives(types);
    }
  }
}

}  // namespace

std::string OptionName(std::string_view written) {
  std::string name(written);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

const OptionRow* FindOption(std::string_view written, const OptionTable& table) {
  const std::string name = OptionName(written);
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const OptionRow& row) { return row.name == name; });
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string> OptionNames(const OptionTable& table) {
  std::vector<std::string> names;
  for (const OptionRow& row : table) names.push_back(row.name);
  return names;
}

std::string CommandLineName(const OptionRow& row) {
  std::string flag = row.name;
  std::replace(flag.begin(), flag.end(), '_', '-');
  return "--" + flag;
}

std::string RangeText(const OptionRow& row) {
  if (!HasRange(row.kind)) return "";
  if (row.low == std::numeric_limits<double>::min()) return "more than 0";
  if (std::isinf(row.high)) return "at least " + NumberText(row.low);
  return NumberText(row.low) + " … " + NumberText(row.high);
}

std::string UsualText(const OptionRow& row) {
  if (!row.usual_words.empty()) return row.usual_words;
  return row.usual.is_null() || row.usual.is_boolean() ? "" : ValueText(row.usual);
}

std::string HelpText(const OptionRow& row) {
  std::string more = row.kind == OptionKind::kChoice ? Alternatives(row.choices) : Joined(row.choices);
  const std::string range = RangeText(row), usual = UsualText(row);
  if (!range.empty()) more += (more.empty() ? "" : "; ") + range;
  if (!usual.empty()) more += (more.empty() ? "" : "; ") + ("default: " + usual);
  return more.empty() ? row.help : row.help + " (" + more + ")";
}

std::string ApiRow(const OptionRow& row, const std::vector<std::string>& collections) {
  const std::string usual = UsualText(row);
  return "| `" + row.name + "` | " + TypeText(row) + " | " +
         (row.usual_words.empty() && !usual.empty() ? "`" + usual + "`" : usual) + " | " +
         Joined(collections) + " |";
}

}  // namespace facetless
