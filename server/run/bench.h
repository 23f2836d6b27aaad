// `facetless bench`: the tables of docs/performance-files.md and docs/performance-published.md, measured here
// and now.
//
//  1. Files are imported as for `render`; of every mesh the importer's process tells how long the mesher
//     alone took, and OpenCASCADE's exact intersector is asked there, too.
//  2. --published measures the papers' tables instead, on scenes of our own; a file then gives the leaves for
//     the comparison of acceleration structures.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/run/run.h"

namespace facetless {

struct BenchSettings {
  int repeats = 5;
  double time_limit_s = 60;  // of one mesh
  double exact_s = 6;        // of OpenCASCADE's exact intersector
  bool published = false;
  bool markdown = false;
  bool growth = true;  // row 9, on the first file and on generated faces
};

struct BenchReport {
  nlohmann::json json;
  std::string text;  // the tables, as the settings say
  std::string plot;  // SVG
};

// `request` has what all imports share (limits, cancel); options: cameras, size, threads. Errors: those of
// Import, kBadUsage (cameras), kCancelled, and those of RenderView.
Result<BenchReport> RunBench(const std::vector<std::string>& files, const ImportRequest& request,
                             const RunOptions& options, const BenchSettings& settings,
                             const RunContext& context);

}  // namespace facetless
