// As much of JSON Schema as openapi.json uses: type, required, enum, properties, items, anyOf, allOf and
// $ref.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace facetless {

// `json` with its $ref followed within `document`, as often as needed. Null where it leads nowhere.
nlohmann::json Resolved(const nlohmann::json& document, nlohmann::json json);

// What of `value` is not as `schema` says, each with the place in it; nothing if all is well. A keyword that
// is not known is a fault, too: it would be taken for a check.
std::vector<std::string> SchemaFaults(const nlohmann::json& document, const nlohmann::json& schema,
                                      const nlohmann::json& value, const std::string& place = "$");

}  // namespace facetless
