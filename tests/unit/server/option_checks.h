// Where openapi.json and the documentation differ from the option table: one sentence for each difference,
// which names the option. They are written by people; the table is what the program does.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/options/option_table.h"

namespace facetless {

// What openapi.json says about the option: type, range, choices and default. Without a description.
nlohmann::json OptionSchema(const OptionRow& row);

// `properties`: of the schema "Options". Every option of requests is there as OptionSchema says it, and
// nothing else.
std::vector<std::string> SchemaDifferences(const OptionTable& table, const nlohmann::json& properties);

// `text`: of docs/cli.md. Under the heading that is the option's group there is one row "| `--margin SHARE` |
// … | `0.05` |", whose second cell has the range or the choices, and no row of an option that there is not.
std::vector<std::string> CliDocsDifferences(const OptionTable& table, const std::string& text);

// `text`: of docs/api.md. The table under "Options of a request" has the rows that ApiRow makes, in the order
// of the option table.
std::vector<std::string> ApiDocsDifferences(const OptionTable& table, const std::string& text);

}  // namespace facetless
