#include "tests/unit/server/option_checks.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "server/service/jobs/job_kinds.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

void StoreRange(const OptionRow& row, Json& schema) {
  if (row.low == std::numeric_limits<double>::min()) {
    schema["exclusiveMinimum"] = 0;
  } else {
    schema["minimum"] = row.low;
  }
  if (!std::isinf(row.high)) schema["maximum"] = row.high;
}

bool IsOfRequests(const OptionRow& row) {
  return row.owner == OptionOwner::kCaller;
}

std::string Without(std::string text, char unwanted) {
  std::erase(text, unwanted);
  return text;
}

bool IsPartOfWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Returns whether `text` contains `words` as whole words: "0 … 0.4" is not contained in "0 … 0.45".
bool Says(const std::string& text, const std::string& words) {
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
    const std::size_t end = at + words.size();
    const bool begins = at == 0 || (!IsPartOfWord(text[at - 1]) && text[at - 1] != '.');
    const bool ends =
        end == text.size() || (!IsPartOfWord(text[end]) &&
                               !(text[end] == '.' && end + 1 < text.size() && IsPartOfWord(text[end + 1])));
    if (begins && ends) return true;
  }
  return false;
}

// Returns the cells of a row of a table, without surrounding spaces.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line.substr(1));
  for (std::string cell; std::getline(text, cell, '|');) {
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? ""
                                               : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

// Returns the rows of tables under each heading that begin with code.
std::map<std::string, std::vector<std::string>> RowsByHeading(const std::string& text) {
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream lines(text);
  std::string heading;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) heading = line.substr(3);
    if (line.starts_with("| `")) rows[heading].push_back(line);
  }
  return rows;
}

// Returns "`--margin SHARE`".
std::string FirstCell(const OptionRow& row) {
  return "`" + CommandLineName(row) + (row.value.empty() ? "" : " " + row.value) + "`";
}

std::vector<std::string> CellDifferences(const OptionRow& row, const std::vector<std::string>& cells) {
  const std::string what = "docs/cli.md: " + row.name;
  if (cells.size() != 3) return {what + " has " + std::to_string(cells.size()) + " cells, not 3"};
  std::vector<std::string> differences;
  if (cells[0] != FirstCell(row))
    differences.push_back(what + " is written " + cells[0] + ", not " + FirstCell(row));
  if (const std::string range = RangeText(row); !range.empty() && !Says(cells[1], range))
    differences.push_back(what + " lacks its range, " + range);
  // cameras.md lists the views.
  for (const std::string& choice : row.choices)
    if (row.name != "view" && !Says(cells[1], choice))
      differences.push_back(what + " lacks its choice " + choice);
  if (Without(cells[2], '`') != UsualText(row))
    differences.push_back(what + " has the default \"" + cells[2] + "\", not \"" + UsualText(row) + "\"");
  return differences;
}

}  // namespace

Json OptionSchema(const OptionRow& row) {
  Json schema = Json::object();
  switch (row.kind) {
    case OptionKind::kFlag:
      schema["type"] = "boolean";
      break;
    case OptionKind::kInteger:
    case OptionKind::kNumber:
      schema["type"] = row.kind == OptionKind::kInteger ? "integer" : "number";
      StoreRange(row, schema);
      break;
    case OptionKind::kChoice:
      schema["type"] = "string";
      schema["enum"] = row.choices;
      break;
    case OptionKind::kWords:
    case OptionKind::kNumbers: {
      schema["type"] = {"string", "array"};
      Json items = {{"type", row.kind == OptionKind::kWords ? "string" : "number"}};
      if (!row.choices.empty()) items["enum"] = row.choices;
      if (row.kind == OptionKind::kNumbers) StoreRange(row, items);
      schema["items"] = items;
      break;
    }
    default:
      schema["type"] = row.json_types.empty() ? Json("string") : Json(row.json_types);
  }
  if (!row.usual.is_null()) schema["default"] = row.usual;
  return schema;
}

std::vector<std::string> SchemaDifferences(const OptionTable& table, const Json& properties) {
  std::vector<std::string> differences;
  for (const OptionRow& row : table) {
    if (!IsOfRequests(row)) continue;
    if (!properties.contains(row.name)) {
      differences.push_back("openapi.json lacks " + row.name + ": " + OptionSchema(row).dump());
      continue;
    }
    Json written = properties[row.name];
    written.erase("description");
    const Json expected = OptionSchema(row);
    // The table does not determine the elements of lists that have a form of their own.
    if (!expected.contains("items")) written.erase("items");
    if (written != expected)
      differences.push_back("openapi.json says of " + row.name + " " + written.dump() + ", not " +
                            expected.dump());
  }
  for (const auto& [name, schema] : properties.items())
    if (const OptionRow* row = FindOption(name, table);
        row == nullptr || row->name != name || !IsOfRequests(*row))
      differences.push_back("openapi.json has " + name + ", which is no option of requests");
  return differences;
}

std::vector<std::string> CliDocsDifferences(const OptionTable& table, const std::string& text) {
  const auto rows = RowsByHeading(text);
  std::vector<std::string> differences;
  std::set<std::string> groups;
  // Check that the documentation contains every row of the table.
  for (const OptionRow& row : table) {
    groups.insert(row.group);
    const auto under = rows.find(row.group);
    int found = 0;
    for (const std::string& line : under == rows.end() ? std::vector<std::string>() : under->second) {
      const std::string start = "| `" + CommandLineName(row);
      if (!line.starts_with(start + "`") && !line.starts_with(start + " ")) continue;
      ++found;
      const std::vector<std::string> more = CellDifferences(row, CellsOf(line));
      differences.insert(differences.end(), more.begin(), more.end());
    }
    if (found != 1)
      differences.push_back("docs/cli.md has " + std::to_string(found) + " rows of " + row.name +
                            " under \"" + row.group + "\", not one");
  }
  // Check that the table contains every row of the documentation.
  for (const std::string& group : groups) {
    const auto under = rows.find(group);
    for (const std::string& line : under == rows.end() ? std::vector<std::string>() : under->second) {
      if (!line.starts_with("| `--")) continue;
      const std::string name = line.substr(5, line.find_first_of("` ", 5) - 5);
      if (FindOption(name, table) == nullptr)
        differences.push_back("docs/cli.md has --" + name + " under \"" + group + "\", which is no option");
    }
  }
  return differences;
}

std::vector<std::string> ApiDocsDifferences(const OptionTable& table, const std::string& text) {
  std::vector<std::string> expected, differences;
  for (const OptionRow& row : table)
    if (IsOfRequests(row)) expected.push_back(ApiRow(row, CollectionsOf(row)));
  auto rows = RowsByHeading(text);
  const std::vector<std::string>& written = rows["Options of a request"];
  for (const std::string& line : expected)
    if (std::find(written.begin(), written.end(), line) == written.end())
      differences.push_back("docs/api.md lacks the row " + line);
  for (const std::string& line : written)
    if (std::find(expected.begin(), expected.end(), line) == expected.end())
      differences.push_back("docs/api.md has the row " + line + ", which is no option of requests");
  if (differences.empty() && written != expected)
    differences.push_back("docs/api.md has the options in another order, or one twice");
  return differences;
}

}  // namespace facetless
