// Tables 2 to 7 of V. Skala, "Memory saving technique for space subdivision technique", measured on this
// machine: bitmaps per row and column (BMSSM) against scans of min-max boxes and of bounding spheres, with
// their memory.
//
//  1. A scene's time is that of all its primary rays, one candidate counted for each that a method finds; the
//     bitmaps' includes making them. Detailed intersection tests are not in it, as in the paper.
//  2. The efficiency is the scan's time over the bitmaps'.
//  3. Methods take turns, and the median counts. Scans are asked for every kScanRows-th row only: their time
//     is the same for each.
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
  double boxes_ns = 0, spheres_ns = 0, bitmaps_ns = 0;  // per ray, the making of the bitmaps included
  double make_bitmaps_ms = 0;
  double mean_hits = 0;  // boxes that a ray meets
  int max_hits = 0;
  std::size_t boxes_bytes = 0, spheres_bytes = 0, bitmaps_bytes = 0;
};

SkalaCell MeasureSkalaCell(int objects, int size, bool perspective, int repeats);

// All cells of the paper's tables, parallel ones first.
std::vector<SkalaCell> MeasureSkala(int repeats);

// One for each table of the paper, our figure and the paper's in each place; and memory.
std::vector<Table> SkalaTables(const std::vector<SkalaCell>& cells);
nlohmann::json SkalaJson(const std::vector<SkalaCell>& cells);

}  // namespace facetless
