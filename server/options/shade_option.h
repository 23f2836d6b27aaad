// The option `shade`, which selects how surfaces are coloured. Its value is a string as on the command line,
// or a JSON object with the same settings: {"name": "zebra", "stripes": 24, "axis": [0, 0, 1]}.
#pragma once

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/inspect/inspection.h"

namespace facetless {

// Parses the option. Error: kBadUsage, which states what is allowed.
Result<Inspection> ParseShade(const nlohmann::json& json);

// Returns whether the kind shows the smoothness of a surface. If so, the report includes the continuity of
// edges between faces.
bool ShowsSmoothness(InspectionKind kind);

}  // namespace facetless
