// Speed against accuracy: the cost and the error of a view, for every setting of every representation.
//
//     MarkFronts(points, ErrorMeasure::kP99, floor_mm);
//     for (const std::size_t i : ParetoFront(points, TradeCost::kTime, ErrorMeasure::kP99, floor_mm))
//       Print(SettingName(points[i].setting), points[i].total_ms);
//
//  1. A point is one setting of one representation in one view. Its errors are differences from the
//     reference: the same rays, traced directly and certified. A point that could not be measured has a
//     reason, and is ignored otherwise.
//  2. Costs are complete. The cost of a mesh includes meshing and its tree; that of the direct tracer
//     includes its patches, trimming structures and leaves; that of a method (render/compare/method.h)
//     includes making its representation and the trimming structures. Reading the file is in no cost, because
//     all need it. prepare_ms, trace_ms and shade_ms are disjoint, and total_ms is their sum.
//  3. Errors below `floor_mm` are considered equal, because the reference is not more accurate.
//  4. These functions do not measure; they order numbers and write sentences. trade_measure.h measures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "render/compare/difference.h"
#include "render/compare/method.h"
#include "render/trace/direct.h"

namespace facetless {

// A setting of the direct tracer. Tolerances other than the default require kStandard. The memory limit is
// not part of a setting, because budgets are the same for all points.
using DirectSetting = ExactTraceOptions;

// A setting of Facetless's own mesh: the chord error relative to the diagonal, and the angle between
// neighbouring facets.
struct MeshSetting {
  double deflection = 0, angular_deg = 0;
};

using TradeSetting = std::variant<DirectSetting, MeshSetting, MethodChoice>;

inline bool IsDirect(const TradeSetting& setting) {
  return std::holds_alternative<DirectSetting>(setting);
}
inline bool IsMesh(const TradeSetting& setting) {
  return std::holds_alternative<MeshSetting>(setting);
}

// The name of a setting: "certified", "standard, tolerance 1e-3", "mesh 1e-4, 12°", "voxels 128".
std::string SettingName(const TradeSetting& setting);
// The name without the tracer, which the colour in a plot shows: "certified", "tol 1e-3", "1e-4, 12°", "128".
std::string ShortSettingName(const TradeSetting& setting);
// The name of the tracer in reports: "direct", "mesh", or the name of the method.
std::string TracerName(const TradeSetting& setting);

// The statistic of the deviation that is used as the error of a point.
enum class ErrorMeasure : std::uint8_t { kMean, kP95, kP99, kMax };

struct TradePoint {
  TradeSetting setting;
  std::string skipped;  // why there are no numbers; empty: measured
  int repetitions =
      0;  // the times are the median of this many runs after a warm-up; 1: a single run without warm-up
  int mesh_repetitions = 0;  // the same for meshing

  // Costs. model_ms is the part of prepare_ms that is paid once per model, and not again for its next view.
  double mesh_ms = 0, build_ms = 0;     // mesh
  double convert_ms = 0, scene_ms = 0;  // direct, and methods
  double make_ms = 0;                   // methods
  double leaves_ms = 0;                 // all representations that prepare something for the view
  double model_ms = 0, prepare_ms = 0, trace_ms = 0, shade_ms = 0, total_ms = 0;
  double fastest_ms = 0, slowest_ms = 0;  // of the repetitions of leaves, trace and shade
  double picture_ms = 0;                  // time of the antialiased picture for FLIP; not in total_ms
  std::uint64_t mesher_peak_bytes = 0, tracer_peak_bytes = 0;
  std::uint64_t peak_bytes = 0;  // the larger of the two: the mesher is done before the tracer begins
  double deflection_mm = 0;      // of the mesh
  std::uint64_t triangles = 0, leaves = 0;

  // Errors.
  Spread depth_mm, deviation_mm;
  Silhouette silhouette;
  double silhouette_offset_px = 0;  // differing pixels per pixel of the reference's outline
  double flip_mean = 0, flip_p95 = 0;
  double deviation_px_scale = 0;  // pixels per millimetre, at the target of the view

  bool on_time_front = false, on_memory_front = false;

  bool measured() const { return skipped.empty(); }
  double ErrorMm(ErrorMeasure measure) const;
  // The larger of the deviation in pixels and the offset of the silhouette.
  double ErrorPx(ErrorMeasure measure) const;
};

enum class TradeCost : std::uint8_t { kTime, kMemory };
// The cost of a point, in milliseconds or bytes.
double TradePointCost(const TradePoint& point, TradeCost cost);

// The indices of the measured points on the Pareto front, by descending error: no other point is at least as
// good in both error and cost and better in one. Points that are equal in both are all included.
std::vector<std::size_t> ParetoFront(const std::vector<TradePoint>& points, TradeCost cost,
                                     ErrorMeasure measure, double floor_mm);

// Sets on_time_front and on_memory_front.
void MarkFronts(std::vector<TradePoint>& points, ErrorMeasure measure, double floor_mm);

// The mesh settings of a sweep, coarse first. Each deflection is combined with the widest angle. A narrower
// angle is combined with a deflection only if it visibly changes the mesh: an angle is decisive for arcs
// whose radius is below deflection / (1 − cos(angle/2)), and is tried if that radius is between 1 % and a
// third of the diagonal (smaller arcs are hardly visible; above, the deflection has no effect).
std::vector<MeshSetting> MeshSettings(std::vector<double> deflections, std::vector<double> angles_deg);
// The direct settings of a sweep: fast, standard with each tolerance, standard, certified.
std::vector<DirectSetting> DirectSettings(std::vector<double> tolerances);
// The method settings of a sweep: each method at each of its usual numbers, or only at the number that was
// given.
std::vector<MethodChoice> MethodSettings(const std::vector<MethodChoice>& choices);

// Returns whether `a` refines `b`: its deflection is smaller, or is the same and its angle is not wider. If b
// exceeded the budget, a would hardly stay within it.
bool Refines(const MeshSetting& a, const MeshSetting& b);

}  // namespace facetless
