// The parts of report.json that come from an inspection.
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "render/inspect/continuity.h"
#include "render/inspect/picture.h"

namespace facetless {

inline constexpr std::size_t kMostListedBreaks = 200;

// "inspection" of one tracer's view: {"shade", "quantity", "unit", "range", "values": {"count", "none",
// "min", …}, "classes": [{"name", "pixels", "color"}], "faces_hardly_seen": [{"id", "name", "pixels"}]}, each
// only for the kinds that have it.
nlohmann::json InspectionJson(const InspectionView& view, const Model& model);

// {"tolerances", "counts": {"gap", "G0", "G1", "G2"}, "border_edges", "crowded_edges", "unmeasured_edges",
// "worst": {"gap": […], "G0": […], "G1": […]}}; each list is worst first and ends after kMostListedBreaks
// edges.
nlohmann::json ContinuityJson(const Continuity& continuity, const Model& model);

}  // namespace facetless
