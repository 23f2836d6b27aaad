// Implements the part of JSON Schema that openapi.json uses: type, required, enum, properties, items, anyOf,
// allOf and $ref.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

// Follows the $ref of `json` within `document`, repeatedly if needed. Returns null if it leads nowhere.
nlohmann::json Resolved(const nlohmann::json& document, nlohmann::json json);

// Returns how `value` differs from `schema`, with the place of each fault; empty if there is none. An unknown
// keyword is a fault, too, because it would look like a check that never fails.
std::vector<std::string> SchemaFaults(const nlohmann::json& document, const nlohmann::json& schema,
                                      const nlohmann::json& value, const std::string& place = "$");

}  // namespace facetless
