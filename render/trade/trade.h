// Speed against accuracy: what a view costs, and what it gets wrong, for every setting of every representation.
//
//  1. A point is one setting of one representation in one view. Its errors are against the reference: the same rays,
//     traced directly and certified. A point that could not be measured says why, and takes part in nothing
//     else.
//  2. Costs are complete: the mesh pays for meshing and its tree, the direct tracer for its patches, its
//     trimming structures and its leaves, a method (render/compare/method.h) for what it makes of the exact
//     surfaces and for their trimming structures. What all need, reading the file, none pays. prepare_ms,
//     trace_ms and shade_ms are disjoint, and total_ms is their sum.
//  3. Errors below `floor_mm` are equal: the reference does not know itself any better.
//  4. Nothing here measures: numbers in, orders and sentences out. trade_measure.h makes the numbers.
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

// The exact surfaces. A tolerance of 0 is the tracer's own; others go with kStandard.
struct DirectSetting {
  Precision precision = Precision::kStandard;
  double newton_tolerance = 0;
};

// Our own mesh: the chord error relative to the diagonal, and the angle between neighbouring facets.
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

// "certified", "standard, tolerance 1e-3", "mesh 1e-4, 12°", "voxels 128".
std::string SettingName(const TradeSetting& setting);
// The same without what its colour and place say: "certified", "tol 1e-3", "1e-4, 12°", "128".
std::string ShortSettingName(const TradeSetting& setting);
// What its settings have in common in reports: "direct", "mesh", or the method's name.
std::string TracerName(const TradeSetting& setting);

// Which statistic of the deviation stands for a point's error.
enum class ErrorMeasure : std::uint8_t { kMean, kP95, kP99, kMax };

struct TradePoint {
  TradeSetting setting;
  std::string skipped;  // why there are no numbers; empty: measured
  int repetitions =
      0;  // the times are the median of so many, after one that does not count; 1: measured once, without
  int mesh_repetitions = 0;  // the same of meshing

  // Costs. model_ms is the part of prepare_ms that is paid once per model, and not again for its next view.
  double mesh_ms = 0, build_ms = 0;     // mesh
  double convert_ms = 0, scene_ms = 0;  // direct, and methods
  double make_ms = 0;                   // methods
  double leaves_ms = 0;                 // all that has something to prepare for the view
  double model_ms = 0, prepare_ms = 0, trace_ms = 0, shade_ms = 0, total_ms = 0;
  double fastest_ms = 0, slowest_ms = 0;  // of the repetitions of leaves, trace and shade
  double picture_ms = 0;                  // the antialiased picture that FLIP looks at; not in total_ms
  std::uint64_t mesher_peak_bytes = 0, tracer_peak_bytes = 0;
  std::uint64_t peak_bytes = 0;  // the larger of the two: the mesher is done before the tracer begins
  double deflection_mm = 0;      // of the mesh
  std::uint64_t triangles = 0, leaves = 0;

  // Errors.
  Spread depth_mm, deviation_mm;
  Silhouette silhouette;
  double silhouette_offset_px = 0;  // differing pixels per pixel of the reference's outline
  double flip_mean = 0, flip_p95 = 0;
  double deviation_px_scale = 0;  // pixels per millimetre, where the view looks

  bool on_time_front = false, on_memory_front = false;

  bool measured() const { return skipped.empty(); }
  double ErrorMm(ErrorMeasure measure) const;
  // The larger of the deviation in pixels and the silhouette's offset.
  double ErrorPx(ErrorMeasure measure) const;
};

enum class TradeCost : std::uint8_t { kTime, kMemory };
// Milliseconds or bytes.
double CostOf(const TradePoint& point, TradeCost cost);

// Indices of the measured points that no other beats, by error descending: no other point is as good in both
// error and cost and better in one. Of points that are equal in both, all are in it.
std::vector<std::size_t> ParetoFront(const std::vector<TradePoint>& points, TradeCost cost,
                                     ErrorMeasure measure, double floor_mm);

// Sets on_time_front and on_memory_front.
void MarkFronts(std::vector<TradePoint>& points, ErrorMeasure measure, double floor_mm);

// The settings of a sweep of meshes, coarse first. Each deflection goes with the widest angle. A narrower one joins a
// deflection where it changes something that is seen: an angle decides for arcs whose radius is below
// deflection / (1 − cos(angle/2)), and is tried where that radius is between 1 % and a third of the diagonal
// (smaller arcs are hardly seen; above, the deflection decides nothing).
std::vector<MeshSetting> MeshSettings(std::vector<double> deflections, std::vector<double> angles_deg);
// fast, standard with each tolerance, standard, certified.
std::vector<DirectSetting> DirectSettings(std::vector<double> tolerances);
// Each method at each of its usual numbers; one that was given with a number of its own at that alone.
std::vector<MethodChoice> MethodSettings(const std::vector<MethodChoice>& choices);

// Whether `a` refines `b`: a smaller deflection, or the same with no wider an angle. What b's budget did not
// allow, a's would hardly.
bool Refines(const MeshSetting& a, const MeshSetting& b);

}  // namespace facetless
