// A run: from a CAD file, or a model that is already imported, to a directory of pictures, numbers and a
// report.
//
//  1. The command line and the HTTP service call these same functions.
//  2. For each view, DIR receives NAME.direct.png, NAME.depth.tif, NAME.aov.exr if AOVs were asked for that
//     need it, NAME.lines.svg if asked for, NAME.legend.png and NAME.inspection.tif of an inspection that has them, and for
//     a comparison NAME.baseline.png, NAME.baseline-depth.tif, NAME.difference.png and NAME.pixel-….png
//     (render/compare/pixel_data.h; of views up to kMostPixelData pixels); with mesh_deviation mesh.bin
//     (render/compare/mesh_deviation.h); for the run, report.json and report.html, these last. Each file is replaced as a
//     whole.
//     With --sheet there is sheet.png, with --turntable turntable.001.png, … and turntable.webp.
//  3. The report is what docs/api.md says; its "views" entries carry "files", from a role ("direct", "depth",
//     …) to a name in DIR.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/model/mesh.h"
#include "render/model/model.h"
#include "server/options.h"

namespace facetless {

// Reports progress: a stage's name and a fraction 0 … 1. May be empty.
using ProgressCallback = std::function<void(const std::string& stage, double fraction)>;

// A model read from an importer's file, on the heap: scenes point to it.
struct ImportedModel {
  std::unique_ptr<const Model> model;
  std::vector<Mesh> meshes;  // one for each TessellationOptions
  double import_ms = 0;      // wall time of the importer process
  bool import_kept = false;  // an earlier run has paid that
  double load_ms = 0;        // of reading its files
  std::uint64_t import_peak_bytes = 0, import_peak_address_bytes = 0;
};

// Runs the importer and reads what it wrote. Errors: those of RunImporter, ReadModel and LoadMesh.
Result<ImportedModel> Import(const ImportRequest& request);

struct RunContext {
  // True ends the run with kCancelled; options.timeout_s ends it with kLimitExceeded.
  const std::atomic<bool>* cancel = nullptr;
  ProgressCallback progress;
};

// The report's "model". import_ms and import_peak_bytes are those of the process.
nlohmann::json ImportedModelJson(const ImportedModel& imported);

// What was lost on the way in: faces, loops, edges.
std::size_t LossCount(const Model& model);
// False if the file has no length unit that could be read, and none was given: a failure under --strict.
bool KnowsUnit(const Model& model);

// Both write into `directory`, which they create, and return the report. Errors: kBadUsage (cameras),
// kLimitExceeded, kCancelled, kWriteFailed, and those of RenderView and CompareView.
Result<nlohmann::json> RunRender(const ImportedModel& imported, const RunOptions& options,
                                 const std::string& directory, const RunContext& context);
Result<nlohmann::json> RunCompare(const ImportedModel& imported, const Mesh& mesh, const RunOptions& options,
                                  const std::string& directory, const RunContext& context);

// Writes report.json and report.html of a report whose pictures lie in `directory`. Errors: kWriteFailed,
// kFileUnreadable (a picture).
Result<void> WriteReport(const nlohmann::json& report, const std::string& directory);

}  // namespace facetless
