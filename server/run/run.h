// A run: it renders or compares an imported model, and writes a directory of pictures, numbers and a report.
//
//     Result<ImportedModel> imported = Import({.input = "part.step"});
//     if (!imported) return imported.error();
//     Result<nlohmann::json> report = RunRender(imported.value(), options, "out", {});
//
//  1. The command line and the HTTP service call the same functions.
//  2. For each view, DIR receives NAME.direct.png, NAME.depth.tif, NAME.aov.exr if requested AOVs need it,
//     NAME.lines.svg if requested, NAME.legend.png and NAME.inspection.tif if the inspection has them, and
//     for a comparison NAME.baseline.png, NAME.baseline-depth.tif, NAME.difference.png and
//     NAME.pixel-….png (render/compare/pixel_data.h; of views up to kMostPixelData pixels); with
//     mesh_deviation mesh.bin (render/compare/mesh_deviation.h); for the run, report.json and report.html,
//     these last. Each file is replaced as a whole. With --sheet there is sheet.png, with --turntable
//     turntable.001.png, … and turntable.webp.
//  3. The report is what docs/api.md says; its "views" entries carry "files", from a role ("direct", "depth",
//     …) to a name in DIR.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/execution.h"
#include "render/model/mesh.h"
#include "render/model/model.h"
#include "server/options/options.h"
#include "server/run/run_result.h"

namespace facetless {

// Reports progress: the name of a stage and a fraction 0 … 1. May be empty.
using ProgressCallback = std::function<void(const std::string& stage, double fraction)>;

NoBaseline NoBaselineFor(const MeshFailure& failure);
// The reason for a mesh that was made but cannot be used.
NoBaseline NoBaselineFor(const Error& unusable);
NoBaseline PendingBaseline(const std::string& file);

// An imported model. The model is on the heap, because scenes point to it.
struct ImportedModel {
  std::unique_ptr<const Model> model;
  std::vector<Mesh> meshes;  // one for each TessellationOptions
  double import_ms = 0;      // wall time of the importer process
  bool import_kept = false;  // the import was made by an earlier run
  double load_ms = 0;        // time of reading the importer's files
  std::uint64_t import_peak_bytes = 0, import_peak_address_bytes = 0;
};

// Runs the importer and reads its files. Errors: the errors of RunImporter, ReadModel and LoadMesh.
Result<ImportedModel> Import(const ImportRequest& request);

// Loads a mesh that the importer made. Errors: the errors of LoadMesh, and the reason if the mesh is
// unusable.
Result<Mesh> LoadOwnMesh(const std::string& path, const Model& model);
// Returns whether an error with this code in making the baseline leaves the exact half of a comparison valid.
bool CostsTheBaselineOnly(ErrorCode code);

struct RunContext {
  // Its flag ends the run with kCancelled; options.timeout_s ends it with kLimitExceeded.
  Execution execution;
  ProgressCallback progress;
};

// The report's "model". import_ms and import_peak_bytes belong to the importer's process.
nlohmann::json ImportedModelJson(const ImportedModel& imported);

// The number of faces, loops and edges that the import lost.
std::size_t LossCount(const Model& model);
// Returns whether the length unit is known. It is not known if the file has no readable unit and none was
// given, which is a failure under --strict.
bool KnowsUnit(const Model& model);

// Both write into `directory`, which they create. Errors: kBadUsage (cameras), kLimitExceeded, kCancelled,
// kWriteFailed, and those of RenderView and CompareView.
Result<RunResult> RunRender(const ImportedModel& imported, const RunOptions& options,
                            const std::string& directory, const RunContext& context);
// If a mesh made by Facetless cannot be traced, the comparison has no baseline.
Result<RunResult> RunCompare(const ImportedModel& imported, const Mesh& mesh, const RunOptions& options,
                             const std::string& directory, const RunContext& context);
// The exact half of a comparison: the result says in no_baseline why there is no other, and its verdict has
// exit code kExitNoBaseline.
Result<RunResult> RunWithoutBaseline(const ImportedModel& imported, const NoBaseline& why,
                                     const RunOptions& options, const std::string& directory,
                                     const RunContext& context);
// Such a result, whose files lie in `directory`, with another reason; its report is written anew.
Result<RunResult> WithReason(RunResult result, const NoBaseline& why, const std::string& directory);

// Writes report.json and report.html of a result whose pictures lie in `directory`, and adds them to its files.
// Errors: kWriteFailed, kFileUnreadable (a picture).
Result<void> WriteReport(RunResult& result, const std::string& directory);

}  // namespace facetless
