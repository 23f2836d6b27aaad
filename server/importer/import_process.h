// Runs `facetless-import` on one file. This is the only way from a CAD file to a Model.
//
//     Result<ImportedFiles> files = RunImporter({.input = "part.step"});
//     if (!files) return files.error();
//     Result<Model> model = ReadModel(files.value().model_path);
//
//  1. The importer is a separate process (child_process.h) with limits on memory, CPU time, wall time,
//     threads, files and output. It cannot use sockets, start processes or send signals to other processes
//     (syscall_filter.h). It runs in an empty directory of its own; outside of it, it can read only its input and
//     the system's libraries (file_access.h).
//  2. Whatever the file causes, RunImporter returns either files or one Error, and leaves nothing behind
//     except what ImportedFiles owns.
//  3. Nothing from the importer is trusted. Its files must be regular files with a single name, in its
//     directory. Its answer is checked before it is used, and its messages are shortened and made printable.
//  4. The importer first writes the complete model, and then makes the meshes. Meshing has a time limit of
//     its own. If the caller can use the model alone (model_suffices), a failure of the mesher loses the
//     meshes but not the model.
//  5. The importer is started for the file, or forked by one that is loaded already (fork_server.h), under the same
//     restrictions.
//  6. The importer is the program next to the running binary, unless the environment variable
//     FACETLESS_IMPORTER names another one.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/execution.h"
#include "render/base/result.h"
#include "server/base/temp_dir.h"
#include "server/importer/fork_server.h"
#include "server/importer/import_summary.h"

namespace facetless {

struct TessellationOptions {
  double deflection = 1e-3;  // relative to the diagonal of the bounding box; used if deflection_mm is 0
  double deflection_mm = 0;
  double angular_deg = 20;
};

struct ImportLimits {
  double timeout_s = 300;          // wall time without meshing; --import-timeout
  double mesh_timeout_s = 300;     // wall time of meshing, for all meshes together; --mesh-timeout
  std::uint64_t memory_mb = 8192;  // address space; --import-memory
  std::uint64_t file_mb = 4096;    // total size of the files that the importer writes
};

// Rays for OpenCASCADE's exact intersector, which exists only in the importer's process.
struct IntersectorRays {
  std::vector<std::array<double, 6>> rays;  // origin, direction
  double near = 0;                          // if above 0, hits at a smaller depth are ignored, mm
  double seconds = 10;                      // time limit: as many rays as possible are answered within it
};

struct ImportRequest {
  std::string input;
  std::vector<TessellationOptions> meshes;  // one mesh file each; empty: the model only
  bool model_suffices = false;              // law 4
  IntersectorRays exact;                    // rays to intersect; may be empty
  double unit_mm = 0;                       // if above 0, the unit of the file, whatever the file states
  ImportLimits limits;
  std::string temp_parent;            // parent directory of the files; empty: $TMPDIR or /tmp
  Execution execution;                // its number of threads also limits the importer's
  ForkServer* fork_server = nullptr;  // made with ImporterForkServer; null: the program is started
  // `stage` is read, transfer, convert, mesh or intersect; fraction 0 … 1. Called on the caller's thread.
  std::function<void(const std::string& stage, double fraction)> progress;
  // Called on the caller's thread when the model is complete and the mesher starts. The importer still runs
  // and could change its files, so a callback that uses the model must copy it first.
  std::function<void(const std::string& model_path)> model_written;
  // Called when the importer has ended, however it ended. `forked` tells whether the fork server started it.
  std::function<void(bool forked)> ended;
  // Called if the importer did not end by itself, or if its answer was unusable. `cause` is crash, timeout,
  // memory, output (too many or too large files), threads or answer.
  std::function<void(const std::string& cause)> died;
};

// The reason why there is no mesh. `reason` is timeout, memory, crash, output (too many or too large files),
// threads or failed (the mesher itself reported `error`).
struct MeshFailure {
  std::string reason;
  Error error;
};

struct ImportedFiles {
  TempDir directory;  // contains all files
  std::string model_path;
  std::vector<std::string> mesh_paths;      // in the order of ImportRequest::meshes; empty after a failure
  std::optional<MeshFailure> mesh_failure;  // only with ImportRequest::model_suffices
  ImportSummary summary;                    // without meshes after a failure
  nlohmann::json answer;                    // what the importer wrote; null after a failure
  std::vector<double> exact_depths;  // depths of the first rays of ImportRequest::exact; infinite for a miss
  double wall_ms = 0;
  std::uint64_t peak_bytes = 0;
  std::uint64_t peak_address_bytes = 0;  // limited by ImportLimits::memory_mb
};

// Runs the importer. Errors: kFileUnreadable (the input is absent or not a regular file); kImporterCrashed
// (the message names the signal, the last line of output, or the fault in the answer); kLimitExceeded (the
// message names the limit, and the option that raises it if there is one); kCancelled; kInternal (there is no
// importer); and all errors that the importer itself reports.
Result<ImportedFiles> RunImporter(const ImportRequest& request);

// The settings of a fork server for RunImporter, without its log.
ForkServerSettings ImporterForkServer();

// The error code with the given stable name (ErrorCodeName); kInternal for an unknown name.
ErrorCode ErrorCodeFromName(const std::string& name);

}  // namespace facetless
