// The parts of report.json that come from rendering. docs/api.md documents their names and units: ms, mm,
// bytes, pixels.
//
//  1. A number that does not exist is null: psnr of equal pictures, a distance to nothing, odd_rays without
//     an audit.
//  2. Objects have at least the documented names. New names may be added, but none is ever renamed.
//  3. open_edges has at most kMostListedEdges entries, and lists of faces at most kMostListedFaces (the worst
//     ones, or those with the lowest ids). The full number is next to the list.
#pragma once

#include <cstddef>

#include <nlohmann/json.hpp>

#include "render/baseline/tracer.h"
#include "render/compare/compare_view.h"
#include "render/model/model.h"

namespace facetless {

inline constexpr std::size_t kMostListedFaces = 1000;
inline constexpr std::size_t kMostListedEdges = 100;

// {"eye", "target", "up", "projection", "height" | "fov_y_deg", "width", "height_px"}
nlohmann::json CameraJson(const Camera& camera);

// "model": {"file", "sha256", "format", "unit", "diagonal_mm", "bounds_mm", "solids", "faces",
// "faces_skipped", "loops_lost", …}
nlohmann::json ModelJson(const Model& model);

// The counters of a trace: {"rays", "hits", "leaves", "hard_leaves", "candidates", "solves", "iterations", "fallbacks",
// "trim_tests", "certified", "converged", "unresolved", "isa"}.
nlohmann::json TraceCountersJson(const DirectStats& stats);

// "direct", "baseline" and "difference" of one view. DirectJson requires a view of exact surfaces.
nlohmann::json DirectJson(const View& view);
nlohmann::json BaselineJson(const View& view, const BaselineScene& scene);
nlohmann::json DifferenceJson(const Difference& difference, const DifferencePicture& picture);

// One entry of "candidates" of one view: {"name", "title", "timing_ms", "rays", "hits", "facts",
// "peak_bytes", "difference"}.
nlohmann::json CandidateJson(const CandidateView& candidate);

// One entry of "views". The reference must be exact surfaces. `baseline` is the scene of the first candidate,
// if that is a mesh, which gives "baseline" and "difference"; null if no mesh was compared. Other candidates
// are in "candidates", which is absent if there are none.
nlohmann::json ComparisonJson(const ViewComparison& comparison, const BaselineScene* baseline);

}  // namespace facetless
