// Tables 2 to 5 of A. Sisojevs, "3D scene rendering" (2011): the methods of the thesis beside those that it compares with,
// on scenes of our own, and the direct renderer on the same rays.
//
//     for (const ThesisTable& table : ThesisTables())
//       for (const NamedScene& scene : table.scenes) scenes.push_back(MeasureThesisScene(table, scene, options));
//
//  1. A table has the thesis's methods, in its order, by the names of FindSolver, and its image size. The methods of the
//     thesis begin at the map of preliminary values with 8 bits, or with wide numbers where a scene has more surfaces than
//     8 bits count. A method that does not exist, or does not take the scene, has no figures, and the table says why.
//  2. All methods run on one thread and take turns. A time is that of preparation and tracing of one picture, without
//     reading the model and without light; the median of the runs. A method whose first run takes more than ten seconds is
//     not run again.
//  3. Errors are judged by the certified image of the same rays (hit_errors.h).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/patch_scene.h"
#include "bench/table.h"
#include "render/base/execution.h"
#include "render/base/result.h"
#include "render/compare/hit_errors.h"
#include "render/solve/solver_trace.h"
#include "render/trace/direct.h"

namespace facetless {

struct ThesisMethod {
  std::string name;
  // The published time for each scene of the table, in the unit of that scene. Empty: the thesis does not have this
  // variant, which is there to tell what the difference comes from.
  std::vector<double> published = {};
  std::optional<SolverStarts> starts = {};  // nothing: those that the thesis describes
};

struct ThesisTable {
  int number = 0;
  std::string surfaces;  // "Bézier surfaces"
  int width = 512, height = 512;
  std::size_t base = 0;  // the method that has 100 % in the thesis
  std::vector<ThesisMethod> methods;
  std::vector<NamedScene> scenes;
};
// The four tables. Building the scenes takes a moment.
std::vector<ThesisTable> ThesisTables();

// What one method needs for a scene.
struct ThesisFigures {
  std::string name, title;
  std::string missing;  // why there are no figures; empty: there are
  double total_ms = 0, trace_ms = 0;
  SolverStats stats;
  HitErrors errors;  // without the samples
};

struct ThesisScene {
  std::string name;
  std::vector<ThesisFigures> methods;  // as in the table
  double direct_ms = 0, direct_trace_ms = 0;
  DirectStats direct;
};

struct ThesisOptions {
  int repeats = 3;
  int divisor = 1;           // of the image size; tests take small images
  Execution execution = {};  // its threads are not used
};

// Errors: those of TraceDirect, and kCancelled.
Result<ThesisScene> MeasureThesisScene(const ThesisTable& table, const NamedScene& scene,
                                       const ThesisOptions& options);

// The times beside the published ones, with a sentence for each difference; and what the times were spent on. Requires a
// measured scene for each scene of the table.
std::vector<Table> ThesisTexts(const ThesisTable& table, const std::vector<ThesisScene>& scenes);
nlohmann::json ThesisJson(const ThesisTable& table, const std::vector<ThesisScene>& scenes);

}  // namespace facetless
