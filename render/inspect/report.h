// The parts of report.json that come from an inspection.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "render/inspect/continuity.h"
#include "render/inspect/picture.h"

namespace facetless {

inline constexpr std::size_t kMostListedBreaks = 200;

// "inspection" of one tracer's view: {"shade", "quantity", "unit", "range", "values": {"count", "none",
// "min", …}, "classes": [{"name", "pixels", "color"}], "faces_hardly_seen": [{"id", "name", "pixels"}]}, each
// only for the kinds that have it.
nlohmann::json InspectionJson(const InspectionView& view, const Model& model);

// The sentence that most pixels of a measured view show the inside of a surface, where the file says what the
// outside is; empty where that is not so. It is InspectionJson's "note".
std::string SideNote(const InspectionView& view);

// {"tolerances", "counts": {"gap", "G0", "G1", "G2"}, "border_edges", "crowded_edges", "unmeasured_edges",
// "worst": {"gap": […], "G0": […], "G1": […]}}; each list is worst first and ends after kMostListedBreaks
// edges.
nlohmann::json ContinuityJson(const Continuity& continuity, const Model& model);

}  // namespace facetless
