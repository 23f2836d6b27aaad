// Tables 2 to 7 of V. Skala, "Memory saving technique for space subdivision technique", measured on this
// machine: bitmaps per row and column (BMSSM) against scans of min-max boxes and of bounding spheres, with
// their memory.
//
//  1. A scene's time covers all its primary rays, and visits each candidate that a method finds. The time of
//     the bitmaps includes making them. Exact intersection tests are not included, as in the paper.
//  2. The efficiency is the scan's time divided by the bitmaps' time.
//  3. Methods take turns, and the median counts. Scans trace only every kScanRows-th row, because each row
//     takes the same time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/table.h"

namespace facetless {

inline constexpr std::array<int, 7> kSkalaObjects = {400, 630, 1000, 1600, 2500, 4000, 6300};
inline constexpr std::array<int, 6> kSkalaSizes = {10, 16, 25, 40, 63, 100};
inline constexpr int kScanRows = 16;

struct SkalaCell {
  int objects = 0, size = 0;
  bool perspective = false;
  double boxes_ns = 0, spheres_ns = 0, bitmaps_ns = 0;  // per ray; includes making the bitmaps
  double make_bitmaps_ms = 0;
  double mean_hits = 0;  // mean number of boxes that a ray meets
  int max_hits = 0;
  std::size_t boxes_bytes = 0, spheres_bytes = 0, bitmaps_bytes = 0;
};

SkalaCell MeasureSkalaCell(int objects, int size, bool perspective, int repeats);

// Measures all cells of the paper's tables, the parallel ones first.
std::vector<SkalaCell> MeasureSkala(int repeats);

// Returns one table for each table of the paper, with our figure and the paper's in each cell, and a table of
// memory.
std::vector<Table> SkalaTables(const std::vector<SkalaCell>& cells);
nlohmann::json SkalaJson(const std::vector<SkalaCell>& cells);

}  // namespace facetless
