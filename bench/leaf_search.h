// Structures that find the leaves of a view for a ray, over the leaves of a real model: bitmaps per tile
// (BMSSM, render/accel), a plain scan of boxes, bounding circles, a bounding volume hierarchy, and Embree's
// tree of user geometry.
//
//  1. All hold the same leaves, those with a certificate, and ask the same solver: a structure has no other
//     way to a hit. Trimming is not asked.
//  2. The same rays one by one, on one thread: those of every kTileStep-th tile. Scans are asked fewer of
//     them where they are slow.
//  3. All see the same depth along every ray, to the bit, or the comparison says nothing: `unlike` counts
//     rays that differ.
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
  std::uint64_t rays = 0;         // asked
  double ns_per_ray = 0;          // bitmaps: making those of the tile included
  double search_ns_per_ray = 0;   // without the solver
  double candidates_per_ray = 0;  // leaves whose solver was asked
  std::uint64_t hits = 0, unlike = 0;
};

struct LeafSearches {
  std::string file, view;
  std::uint64_t leaves = 0, left_out = 0;  // left out: without a certificate
  std::vector<LeafSearch> methods;         // the bitmaps first
};

// Errors: those of TraceDirect; kNothingUsable (no leaf in view); those of BoxTree.
Result<LeafSearches> MeasureLeafSearches(const std::string& file, const Model& model, const Camera& camera,
                                         int repeats);

Table LeafSearchTable(const LeafSearches& searches);
nlohmann::json LeafSearchJson(const LeafSearches& searches);

}  // namespace facetless
