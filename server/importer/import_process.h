// Runs `facetless-import` on one file: the only way from a CAD file to a Model.
//
//  1. The importer is a process of its own (child_process.h), under limits of memory, processor time, wall
//     time, threads, files and what it writes, without sockets, processes or signals to others (sandbox.h),
//     in an empty directory of its own, beside which it may read its input and the system's libraries alone
//     (file_access.h).
//  2. Whatever the file does to it, RunImporter returns either files or one Error, and leaves nothing behind
//     but what ImportedFiles owns.
//  3. Nothing that the importer says is trusted: its files are regular ones that only this directory names,
//     its answer is checked before it is used, and what it says in words is cut and made printable.
//  4. The importer writes the model first, whole, and then makes the meshes. Meshing has a budget of time of
//     its own. Where the caller says that the model alone is of use (model_suffices), a mesher that fails
//     costs the meshes and not the model.
//  5. The importer is found beside the running binary; the environment variable FACETLESS_IMPORTER names
//     another one.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/base/temp_dir.h"

namespace facetless {

struct TessellationOptions {
  double deflection = 1e-3;  // relative to the diagonal of the bounding box; used if deflection_mm is 0
  double deflection_mm = 0;
  double angular_deg = 20;
};

struct ImportLimits {
  double timeout_s = 300;          // wall clock of all but meshing; --import-timeout
  double mesh_timeout_s = 300;     // wall clock of meshing, of all meshes together; --mesh-timeout
  std::uint64_t memory_mb = 8192;  // address space; --import-memory
  std::uint64_t file_mb = 4096;    // of all files that it writes
};

// Rays for OpenCASCADE's exact intersector, which only the importer's process knows.
struct ExactRays {
  std::vector<std::array<double, 6>> rays;  // origin, direction
  double near = 0;                          // above 0: only hits at a depth of at least this count
  double seconds = 10;                      // answer as many as this allows
};

struct ImportRequest {
  std::string input;
  std::vector<TessellationOptions> meshes;  // one file each; none: the model only
  bool model_suffices = false;              // law 4
  ExactRays exact;                          // without rays: nothing is asked
  double unit_mm = 0;                       // above 0: one unit of the file, whatever the file says
  ImportLimits limits;
  std::string temp_parent;  // where the files go; empty: $TMPDIR or /tmp
  const std::atomic<bool>* cancel = nullptr;
  // `stage` is read, transfer, convert, mesh or intersect; fraction 0 … 1. Called on the caller's thread.
  std::function<void(const std::string& stage, double fraction)> progress;
  // Called on the caller's thread when the model is whole and the mesher begins. The importer still runs and
  // could change its files, so that who wants the model now must copy it first.
  std::function<void(const std::string& model_path)> model_written;
  // Called if the importer did not end by itself, or its answer could not be used. `cause` is crash, timeout,
  // memory, output (files too many or too large), threads or answer.
  std::function<void(const std::string& cause)> died;
};

// Why there is no mesh. `reason` is timeout, memory, crash, output (files too many or too large), threads or
// failed (the mesher's own answer, which `error` has).
struct MeshFailure {
  std::string reason;
  Error error;
};

struct ImportedFiles {
  TempDir directory;  // holds all of them
  std::string model_path;
  std::vector<std::string> mesh_paths;      // in the order of ImportRequest::meshes; empty after a failure
  std::optional<MeshFailure> mesh_failure;  // only with ImportRequest::model_suffices
  nlohmann::json summary;                   // the importer's own answer; null after a failure
  std::vector<double> exact_depths;  // of the first of ImportRequest::exact's rays; infinite for a miss
  double wall_ms = 0;
  std::uint64_t peak_bytes = 0;
  std::uint64_t peak_address_bytes = 0;  // what ImportLimits::memory_mb limits
};

// Errors: kFileUnreadable (absent or no regular file); kImporterCrashed (names the signal, or its last words,
// or what was wrong with its answer); kLimitExceeded (names the limit, and the option that raises it where
// there is one); kCancelled; kInternal (no importer); and whatever the importer reports.
Result<ImportedFiles> RunImporter(const ImportRequest& request);

// The error code with the given stable name; kInternal for a name that no code has.
ErrorCode ErrorCodeFromName(const std::string& name);

}  // namespace facetless
