// The option `shade`: what pictures show. A string, as the command line has it, or in JSON an object with the
// same settings: {"name": "zebra", "stripes": 24, "axis": [0, 0, 1]}.
#pragma once

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "render/inspect/inspection.h"

namespace facetless {

// Error: kBadUsage names what is allowed.
Result<Inspection> ParseShade(const nlohmann::json& json);

// Whether edges between faces belong into the report: of pictures that show how smooth a surface is.
bool ShowsSmoothness(InspectionKind kind);

}  // namespace facetless
