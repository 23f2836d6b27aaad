// Table 5 of A. Sisojevs, "3D scene rendering": compares Newton–Cramer on projected patches with the method
// of Martin et al., on scenes of our own, and with the direct renderer on the same rays.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/patch_tracers.h"
#include "bench/table.h"
#include "render/base/result.h"
#include "render/trace/direct.h"

namespace facetless {

inline constexpr int kThesisSize = 512;  // pixels on a side

struct ThesisScene {
  std::string name;
  std::size_t patches = 0, pieces = 0;
  double martin_ms = 0, newton_cramer_ms = 0, direct_ms = 0;  // preparation and tracing, one thread
  double martin_trace_ms = 0, newton_cramer_trace_ms = 0, direct_trace_ms = 0;  // tracing alone
  PatchImage martin, newton_cramer;                                             // images of the last run
  DirectStats direct;
  std::size_t direct_bytes = 0;
  // Differences from the direct image.
  DepthDifferences martin_differences, newton_cramer_differences;
};

// Errors: those of TraceDirect.
Result<ThesisScene> MeasureThesisScene(const NamedScene& scene, int size, int repeats);

std::vector<Table> ThesisTables(const std::vector<ThesisScene>& scenes);
nlohmann::json ThesisJson(const std::vector<ThesisScene>& scenes);

}  // namespace facetless
