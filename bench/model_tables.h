// Tables of what was measured on files beyond the rows. They are made from ModelCosts::details and its
// counters.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/trace/direct.h"

namespace facetless {

// CostTable shows where the time of one thread went on each file. CounterTable shows what the direct renderer
// counted there. Both read ModelCosts::details.
Table CostTable(const std::vector<nlohmann::json>& details);
Table CounterTable(const std::vector<nlohmann::json>& details);

// Returns the counters of a trace, and the ratios between them.
nlohmann::json CountersJson(const DirectStats& stats);

}  // namespace facetless
