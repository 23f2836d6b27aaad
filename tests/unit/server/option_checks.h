// Finds differences of openapi.json and the documentation from the option table. Each difference is a
// sentence that names the option. People write those texts; the table determines what the program does.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/options/option_table.h"

namespace facetless {

// Returns what openapi.json must say about the option: type, range, choices and default, without a
// description.
nlohmann::json OptionSchema(const OptionRow& row);

// `properties` are those of the schema "Options". They must contain every option of requests as OptionSchema
// returns it, and nothing else.
std::vector<std::string> SchemaDifferences(const OptionTable& table, const nlohmann::json& properties);

// `text` is that of docs/cli.md. Under the heading of the option's group there must be one row "| `--margin
// SHARE` | … | `0.05` |", whose second cell has the range or the choices, and no row of an unknown option.
std::vector<std::string> CliDocsDifferences(const OptionTable& table, const std::string& text);

// `text` is that of docs/api.md. The table under "Options of a request" must have the rows that ApiRow makes,
// in the order of the option table.
std::vector<std::string> ApiDocsDifferences(const OptionTable& table, const std::string& text);

}  // namespace facetless
