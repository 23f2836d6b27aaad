// The parts of report.json that come from an inspection.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "render/inspect/continuity.h"
#include "render/inspect/picture.h"

namespace facetless {

inline constexpr std::size_t kMostListedBreaks = 200;

// The object "inspection" of one tracer's view: {"shade", "quantity", "unit", "range", "values": {"count",
// "none", "min", …}, "classes": [{"name", "pixels", "color"}], "faces_hardly_seen": [{"id", "name",
// "pixels"}]}. A key is present only for the kinds to which it applies.
nlohmann::json InspectionJson(const InspectionView& view, const Model& model);

// The sentence that most pixels of a measured view show the inside of a surface, where the file says what the
// outside is; empty where that is not so. It is InspectionJson's "note".
std::string SideNote(const InspectionView& view);

// The object "continuity": {"tolerances", "counts": {"gap", "G0", "G1", "G2"}, "border_edges",
// "crowded_edges", "unmeasured_edges", "worst": {"gap": […], "G0": […], "G1": […]}}. Each list is sorted
// worst first and holds at most kMostListedBreaks edges.
nlohmann::json ContinuityJson(const Continuity& continuity, const Model& model);

}  // namespace facetless
