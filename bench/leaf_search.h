// Compares structures that find the leaves of a view that a ray may hit, over the leaves of a real model:
// bitmaps per tile (BMSSM, render/accel), a scan of boxes, a scan of bounding circles, a bounding volume
// hierarchy, and Embree's tree of user geometry.
//
//  1. All structures contain the same leaves, those with a certificate, and use the same solver to compute
//     hits. Trimming is ignored.
//  2. The same rays are traced one by one, on one thread: those of every kTileStep-th tile. Slow scans trace
//     fewer of them.
//  3. All structures must find bitwise equal depths along every ray; otherwise the comparison is meaningless.
//     `unlike` counts the rays that differ.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"
#include "render/base/result.h"
#include "render/trace/direct.h"

namespace facetless {

inline constexpr int kTileStep = 4;

struct LeafSearch {
  std::string name;
  double build_ms = 0;
  std::size_t bytes = 0;
  std::uint64_t rays = 0;         // rays that were traced
  double ns_per_ray = 0;          // for the bitmaps, includes making the bitmaps of the tile
  double search_ns_per_ray = 0;   // without the time of the solver
  double candidates_per_ray = 0;  // leaves for which the solver was called
  std::uint64_t hits = 0, unlike = 0;
};

struct LeafSearches {
  std::string file, view;
  std::uint64_t leaves = 0, left_out = 0;  // left_out: leaves without a certificate
  std::vector<LeafSearch> methods;         // the bitmaps come first
};

// Errors: those of TraceDirect; kNothingUsable (no leaf in view); those of BoxTree.
Result<LeafSearches> MeasureLeafSearches(const std::string& file, const Model& model, const Camera& camera,
                                         int repeats);

Table LeafSearchTable(const LeafSearches& searches);
nlohmann::json LeafSearchJson(const LeafSearches& searches);

}  // namespace facetless
