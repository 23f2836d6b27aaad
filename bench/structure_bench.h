// All structures of render/accel for rays in any direction, over the same boxes and the same rays: what
// building them takes, what they cost per ray, and how that compares with the estimates of their sources.
//
//     const std::vector<Box3> boxes = LeafBoxes(model, 200'000);
//     auto bench = MeasureStructures("part.step", boxes, BoxEntry{boxes}, {.repeats = 3});
//
//  1. Rays come in four kinds. Primary rays come from an eye outside. Shadow rays go from what primary rays
//     meet to a light, and ambient rays to all sides over a share of the scene. Random rays begin and point
//     anywhere. Shadow and ambient rays end at the first hit (occlusion), the others find the nearest hit.
//  2. The object is a callable: double object(id, segment) returns the first t of the segment at which the
//     ray meets object `id`, or infinity. BoxEntry takes the boxes themselves for objects.
//  3. Structures take turns, one thread asks the rays one by one, and the median counts. Where a structure is
//     slow, it is asked fewer rays (kMostMilliseconds), at equal distances in the list.
//  4. Every structure must give the same answers as a bounding volume hierarchy, to the bit: `unlike` counts
//     rays that differ.
//  5. The share of tests that a source estimates is d·k/regions, of random rays (EstimatedShare in grid.h),
//     with d and k as measured; of the direction tree, whose rays end in one leaf, d is 1. What was measured
//     is the time of random rays over that of the plain list of boxes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/statistics.h"
#include "bench/table.h"
#include "render/accel/structures.h"
#include "render/base/result.h"
#include "render/base/stopwatch.h"

namespace facetless {

enum class BenchRays : std::uint8_t { kPrimary, kShadow, kAmbient, kRandom };
inline constexpr std::array<const char*, 4> kBenchRayNames = {"primary", "shadow", "ambient", "random"};
inline constexpr double kMostMilliseconds = 100;  // of one run of one structure on one kind of rays
inline constexpr std::size_t kFewRays = 100;      // of a kind, that say how slow a structure is

// What one kind of rays costs in one structure.
struct StructureRays {
  std::uint64_t rays = 0;  // asked
  double ns_per_ray = 0;
  double regions = 0, tests = 0, candidates = 0, repeats = 0;  // per ray; regions is d of the sources
  std::uint64_t hits = 0, unlike = 0;
};

struct StructureRow {
  std::string name;
  double build_ms = 0;
  std::size_t bytes = 0;
  StructureFigures figures;
  std::array<StructureRays, 4> kinds;  // by BenchRays
  double estimated_share = 0;          // of tests; 0: the source has no estimate
};

struct StructureBench {
  std::string scene;
  std::size_t boxes = 0;
  VolumeCosts costs;  // of one test, as measured
  std::vector<StructureRow> rows;
};

struct StructureBenchSettings {
  int repeats = 3;
  std::size_t rays = 20'000;  // of each kind
};

// The boxes as objects: a ray meets one where it enters it, or at its start.
struct BoxEntry {
  const std::vector<Box3>& boxes;
  double operator()(std::uint32_t id, const RaySegment& ray) const;
};

// The scenes of boxes that the sources have: small and large boxes everywhere, and clusters.
struct BoxScenery {
  std::string name;
  std::vector<Box3> boxes;
};
std::vector<BoxScenery> RandomBoxSceneries();

// Rays of two kinds that need no hits, and of the other two from the points where `hits` of primary rays lie
// (infinite: no hit).
std::vector<RaySegment> PrimaryRays(const Box3& bounds, std::size_t count);
std::vector<RaySegment> RandomRays(const Box3& bounds, std::size_t count);
std::vector<RaySegment> ShadowRays(const Box3& bounds, const std::vector<RaySegment>& primary,
                                   const std::vector<double>& hits);
std::vector<RaySegment> AmbientRays(const Box3& bounds, const std::vector<RaySegment>& primary,
                                    const std::vector<double>& hits);

// The estimate of law 5 for a structure by name; 0 if its source has none.
double SourceEstimate(const StructureRow& row, std::size_t boxes);

// Asks every `stride`-th ray. Answers are t of the nearest hit, or 0 of any hit, and infinite without.
template <typename Structure, typename Object>
void AskRays(const Structure& structure, QueryState& state, const std::vector<RaySegment>& rays, bool any,
             const Object& object, std::size_t stride, std::vector<double>& answers) {
  for (std::size_t i = 0; i < rays.size(); i += stride) {
    RaySegment ray = rays[i];
    double nearest = INFINITY;
    structure.Visit(rays[i], state, [&](std::uint32_t id) {
      const double t = object(id, ray);
      if (t < nearest) nearest = t;
      if (any && nearest < INFINITY) return kStop;
      return nearest;
    });
    answers[i] = any && nearest < INFINITY ? 0 : nearest;
  }
}

// The distance of the rays that are asked, if all of them took `all_ms`.
inline std::size_t RayStride(double all_ms) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(all_ms / kMostMilliseconds));
}

// Measures one structure on one kind of rays.
template <typename Object>
StructureRays MeasureRays(const AnyStructure& structure, const std::vector<RaySegment>& rays, bool any,
                          const Object& object, int repeats, const std::vector<double>* expected,
                          std::vector<double>* found) {
  StructureRays result;
  if (rays.empty()) return result;
  WithStructure(structure, [&](const auto& s) {
    // A few rays wake what is made on demand, and say then how slow the structure is.
    std::vector<double> answers(rays.size(), INFINITY);
    QueryState state(s.state_size());
    const std::size_t few = std::max<std::size_t>(1, rays.size() / kFewRays);
    AskRays(s, state, rays, any, object, few, answers);
    const Stopwatch sample;
    AskRays(s, state, rays, any, object, few, answers);
    const std::size_t stride =
        found != nullptr ? 1 : RayStride(sample.Milliseconds() * static_cast<double>(few));
    AskRays(s, state, rays, any, object, stride, answers);
    state.counters = {};
    std::vector<double> times;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      state.counters = {};
      const Stopwatch stopwatch;
      AskRays(s, state, rays, any, object, stride, answers);
      times.push_back(stopwatch.Milliseconds());
    }
    for (std::size_t i = 0; i < rays.size(); i += stride) {
      ++result.rays;
      result.hits += answers[i] < INFINITY;
      result.unlike += expected != nullptr && answers[i] != (*expected)[i];
    }
    const double asked = static_cast<double>(result.rays);
    result.ns_per_ray = 1e6 * Median(times) / asked;
    result.regions = static_cast<double>(state.counters.regions) / asked;
    result.tests = static_cast<double>(state.counters.tests) / asked;
    result.candidates = static_cast<double>(state.counters.candidates) / asked;
    result.repeats = static_cast<double>(state.counters.repeats) / asked;
    if (found != nullptr) *found = answers;
  });
  return result;
}

// Measures all structures. Errors: those of MakeStructure; kNothingUsable (there is no box).
template <typename Object>
Result<StructureBench> MeasureStructures(const std::string& scene, const std::vector<Box3>& boxes,
                                         const Object& object, const StructureBenchSettings& settings) {
  if (boxes.empty()) return Error{ErrorCode::kNothingUsable, scene + " has no surface to find"};
  StructureBench bench{scene, boxes.size(), MeasureVolumeCosts(), {}};
  Box3 bounds;
  for (const Box3& box : boxes) bounds.Add(box.low), bounds.Add(box.high);

  // The answers of a hierarchy are what the others are compared with, and where secondary rays begin.
  const Result<AnyStructure> reference = MakeStructure("bvh", boxes);
  if (!reference) return reference.error();
  std::array<std::vector<RaySegment>, 4> rays;
  std::array<std::vector<double>, 4> answers;
  const auto answer = [&](int kind, bool any) {
    MeasureRays(reference.value(), rays[kind], any, object, 1, nullptr, &answers[kind]);
  };
  rays[0] = PrimaryRays(bounds, settings.rays);
  answer(0, false);
  rays[1] = ShadowRays(bounds, rays[0], answers[0]);
  rays[2] = AmbientRays(bounds, rays[0], answers[0]);
  rays[3] = RandomRays(bounds, settings.rays);
  answer(1, true), answer(2, true), answer(3, false);

  for (const StructureName& name : StructureNames()) {
    StructureRow row;
    row.name = name.name;
    const Stopwatch stopwatch;
    const Result<AnyStructure> made = MakeStructure(name.name, boxes);
    if (!made) return made.error();
    row.build_ms = stopwatch.Milliseconds();
    for (int kind = 0; kind < 4; ++kind)
      row.kinds[kind] = MeasureRays(made.value(), rays[kind], kind == 1 || kind == 2, object,
                                    settings.repeats, &answers[kind], nullptr);
    WithStructure(made.value(), [&](const auto& s) {
      row.bytes = s.bytes();
      row.figures = s.figures();
    });
    row.estimated_share = SourceEstimate(row, boxes.size());
    bench.rows.push_back(std::move(row));
  }
  return bench;
}

std::vector<Table> StructureTables(const StructureBench& bench);
nlohmann::json StructureJson(const StructureBench& bench);

}  // namespace facetless
