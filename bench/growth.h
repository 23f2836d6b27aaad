// Measures how the time of a picture grows with the amount of work: row 9 of the aims.
//
//  1. One series has pictures of one model, from 256² to 4096² pixels. The other has generated scenes of 10²
//     to 10⁵ faces, all in view, on one picture size.
//  2. A time is the sum of trimming structures, preparation and tracing, in standard precision, on one
//     thread. The median of the runs counts.
//  3. The figure is the exponent of the growth of the time, fitted by least squares: for pictures, over the
//     number of rays; for scenes, over the number of leaves seen. 1 is linear.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/aims.h"
#include "bench/table.h"
#include "render/base/result.h"
#include "render/trace/direct.h"

namespace facetless {

struct GrowthStep {
  std::string label;
  int size = 0;  // pixels per side of the picture
  std::size_t faces = 0;
  double scene_ms = 0, prepare_ms = 0, trace_ms = 0;
  DirectStats stats;
  double total() const { return scene_ms + prepare_ms + trace_ms; }
};

struct Growth {
  std::string file, view;
  std::vector<GrowthStep> pictures, scenes;
  double picture_exponent = 0, scene_exponent = 0;
};

struct GrowthRange {
  std::vector<int> sizes = {256, 512, 1024, 2048, 4096};
  std::vector<int> faces = {100, 1000, 10000, 100000};
  int scene_size = 1024;
  int repeats = 3;
};

// `camera` must see `model`; the camera's size is replaced. Errors: those of TraceDirect.
Result<Growth> MeasureGrowth(const std::string& file, const Model& model, const Camera& camera,
                             const GrowthRange& range);

std::vector<BenchValue> GrowthValues(const Growth& growth);
Table GrowthTable(const Growth& growth);
nlohmann::json GrowthJson(const Growth& growth);

}  // namespace facetless
