// How the cost of a picture grows with its work: row 9 of the aims.
//
//  1. Pictures grow from 256² to 4096² pixels, of one model; scenes from 10² to 10⁵ faces, generated, all in
//     view, on one size of picture.
//  2. Times are of trimming structures, preparation and tracing together, in standard precision, on one
//     thread; the median of the runs.
//  3. The figure is the power with which the time grows, by least squares: with the number of rays of the
//     pictures, and of the scenes with the number of leaves seen. 1 is linear.
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
  int size = 0;  // of the picture
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

// `camera` sees `model`; its size is replaced. Errors: those of TraceDirect.
Result<Growth> MeasureGrowth(const std::string& file, const Model& model, const Camera& camera,
                             const GrowthRange& range);

std::vector<BenchValue> GrowthValues(const Growth& growth);
Table GrowthTable(const Growth& growth);
nlohmann::json GrowthJson(const Growth& growth);

}  // namespace facetless
