// What was measured on files, beyond the rows: tables of ModelCosts::details, and the counters in them.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/trace/direct.h"

namespace facetless {

// Where the time of one thread went on each file, and what the direct renderer counted there: of
// ModelCosts::details.
Table CostTable(const std::vector<nlohmann::json>& details);
Table CounterTable(const std::vector<nlohmann::json>& details);

// The counters of a trace, and what follows from them.
nlohmann::json CountersJson(const DirectStats& stats);

}  // namespace facetless
