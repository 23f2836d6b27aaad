// `facetless bench`: measures the tables of docs/performance-files.md and docs/performance-published.md on
// this machine.
//
//  1. Files are imported as for `render`. For every mesh, the importer's process reports the time of the
//     mesher alone. OpenCASCADE's exact intersector also runs in that process.
//  2. Rows 1 to 9 and 11 are measured in this process. Imports (row 10) and the stages of `render` and `compare` are
//     measured on processes of their own.
//  3. --published measures the tables of the published papers instead, on generated scenes. A file then
//     supplies the leaves for the comparison of acceleration structures.
//  4. --openvdb compares voxels and rays through them with OpenVDB's instead, on files (bench_openvdb.h).
//  5. --structures compares the structures of render/accel for rays in any direction instead, on random boxes
//     and on the boxes of each file's surfaces.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "server/run/run.h"

namespace facetless {

struct BenchSettings {
  int repeats = 5;
  double time_limit_s = 60;  // time limit of one mesh
  double exact_s = 6;        // time limit of OpenCASCADE's exact intersector
  bool published = false;
  bool structures = false;
  bool openvdb = false;
  bool markdown = false;
  bool growth = true;  // row 9, on the first file and on generated faces
  bool stages = true;  // the stages of `render` and `compare`, from start to end
};

struct BenchReport {
  nlohmann::json json;
  std::string text;        // the tables, in the form that the settings select
  std::string plot;        // SVG: time to the first image
  std::string stage_plot;  // SVG: stages of the commands
};

// Runs the bench. `request` has the common settings of all imports (limits, execution). Of `options`, cameras,
// and size are used. Errors: the errors of Import, kBadUsage (cameras), kCancelled, and the errors of
// RenderView.
Result<BenchReport> RunBench(const std::vector<std::string>& files, const ImportRequest& request,
                             const RunOptions& options, const BenchSettings& settings,
                             const RunContext& context);

}  // namespace facetless
