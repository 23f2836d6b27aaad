#include "server/service/jobs/job_inputs.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/baseline/mesh_file.h"
#include "render/model/model_file.h"
#include "render/trade/quantity_text.h"
#include "server/base/files.h"
#include "server/base/sha256.h"
#include "server/base/version.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// Returns the store's key of a mesh of our own, which describes how it was made.
std::string MeshKey(const TessellationOptions& mesh) {
  const Json identity = {{"version", Version()},
                         {"deflection", mesh.deflection_mm > 0 ? 0 : mesh.deflection},
                         {"deflection_mm", mesh.deflection_mm},
                         {"angular_deg", mesh.angular_deg}};
  return Sha256Hex(JsonText(identity, -1));
}

}  // namespace

// ---- The model ----

bool JobInputs::wants_tessellation() const {
  return RowOf(job_.kind).compares_mesh && !foreign_mesh();
}

// A file that is read in another unit than its own is another model. To make it, the job needs the file: the
// uploaded one, or the one from which the model was made.
void JobInputs::FindInUnit() {
  if (request_.options.unit_mm == 0) return;
  if (const auto own = store_.FindModel(job_.owner, request_.model_id); own && request_.file_name.empty())
    request_.file_name = own->name;
  source_id_ = request_.model_id;
  const Json identity = {{"model", request_.model_id}, {"unit_mm", request_.options.unit_mm}};
  request_.model_id = Sha256Hex(JsonText(identity, -1));
}

Result<void> JobInputs::MakeModel() {
  FindInUnit();
  stored_ = store_.FindModel(job_.owner, request_.model_id);
  if (stored_) return {};
  if (request_.file_name.empty())
    return Error{ErrorCode::kFileUnreadable, "the model " + request_.model_id + " is not there any more"};
  const auto source = store_.Pin(source_id_.empty() ? request_.model_id : source_id_);
  if (!source) return Error{ErrorCode::kInternal, "the uploaded file is not there any more"};

  // Import the file, and mesh it in the same process.
  std::vector<TessellationOptions> meshes;
  if (wants_tessellation()) meshes.push_back(request_.options.tessellation);
  auto files = Import(source->path, request_.file_name, meshes);
  if (!files) return files.error();

  // Describe the model and store it.
  if (auto described = Describe(files.value(), *source); !described) return described;
  if (!meshes.empty()) {
    auto kept = StoreMesh(files.value(), request_.model_id);
    if (!kept) return kept.error();
  }
  stored_ = store_.FindModel(job_.owner, request_.model_id);
  if (!stored_) return Error{ErrorCode::kWriteFailed, "the model cannot be read back"};
  if (const std::size_t lost = LossCount(*imported_.model); lost > 0)
    Say(std::to_string(lost) + " faces, loops or edges of the file were lost");
  return {};
}

// Reads the importer's files, and moves them into the store.
Result<void> JobInputs::Describe(const ImportedFiles& files, const StoredFile& source) {
  if (auto read = ReadInto(files.model_path); !read) return read;
  imported_.import_ms = files.wall_ms;
  imported_.import_peak_bytes = files.peak_bytes;
  auto model_file = store_.AddFile(files.model_path, "");
  if (!model_file) return model_file.error();
  return store_.PutModel(job_.owner, request_.model_id, request_.file_name, ImportedModelJson(imported_),
                         source, model_file.value());
}

Result<const ImportedModel*> JobInputs::Model() {
  if (imported_.model != nullptr) return &imported_;
  if (auto read = ReadInto(stored_->model_path); !read) return read.error();
  imported_.import_kept = true;
  imported_.import_ms = stored_->import_ms;
  imported_.import_peak_bytes = stored_->import_peak_bytes;
  return &imported_;
}

// This is the only place where a job reads a model.
Result<void> JobInputs::ReadInto(const std::string& path) {
  const Stopwatch stopwatch;
  auto read = ReadModel(path);
  if (!read) return read.error();
  imported_.model = std::make_unique<const facetless::Model>(std::move(read).value());
  imported_.load_ms = stopwatch.Milliseconds();
  constexpr double kMillisecond = 1e-3;
  if (watch_.observer != nullptr && watch_.observer->model_read)
    watch_.observer->model_read(imported_.load_ms * kMillisecond);
  return {};
}

// ---- The mesh ----

Result<ComparisonMesh> JobInputs::MakeMesh() {
  auto path = MeshPath();
  if (!path) return path.error();
  ComparisonMesh made;
  if (no_baseline_) {
    made.none = *no_baseline_;
    return made;
  }
  auto model = Model();
  if (!model) return model.error();
  const facetless::Model& exact = *model.value()->model;
  const MeshLoadOptions how = {.unit = request_.options.mesh_unit, .up = request_.options.mesh_up};
  auto mesh = foreign_mesh() ? LoadMesh(path.value(), how, &exact) : LoadOwnMesh(path.value(), exact);
  if (mesh) {
    made.mesh = std::move(mesh).value();
    return made;
  }
  if (foreign_mesh() || !CostsTheBaselineOnly(mesh.error().code)) return mesh.error();
  made.none = NoBaselineFor(mesh.error());
  return made;
}

// Returns the path of the mesh; "" if there is none, in which case no_baseline_ has the reason.
Result<std::string> JobInputs::MeshPath() {
  if (no_baseline_) return std::string();
  if (foreign_mesh()) {
    posted_mesh_ = store_.Pin(request_.mesh);
    if (!posted_mesh_) return Error{ErrorCode::kInternal, "the uploaded mesh is not there any more"};
    // Errors show the name, so the file gets the name with which it was uploaded.
    return LinkUnderName(posted_mesh_->path, request_.mesh_name.empty() ? "mesh" : request_.mesh_name);
  }
  const std::string key = MeshKey(request_.options.tessellation);
  if (auto known = store_.FindMesh(job_.owner, stored_->id, key)) return *known;
  auto files = Import(stored_->source_path, stored_->name, {request_.options.tessellation});
  if (!files) return files.error();
  return StoreMesh(files.value(), stored_->id);
}

// Stores the mesh of an import and returns its path. If the import made no mesh, it records the reason and
// returns "".
Result<std::string> JobInputs::StoreMesh(const ImportedFiles& files, const std::string& model_id) {
  if (files.mesh_failure) {
    no_baseline_ = NoBaselineFor(*files.mesh_failure);
    return std::string();
  }
  auto mesh = store_.AddFile(files.mesh_paths.front(), "");
  if (!mesh) return mesh.error();
  const std::string key = MeshKey(request_.options.tessellation);
  if (auto put = store_.PutMesh(job_.owner, model_id, key, mesh.value()); !put) return put.error();
  return mesh.value().path;
}

// ---- The importer ----

// Links the file at `path` into a scratch directory of the job under another name, and returns the new path.
Result<std::string> JobInputs::LinkUnderName(const std::string& path, const std::string& name) {
  auto scratch = store_.Scratch();
  if (!scratch) return scratch.error();
  scratch_.push_back(std::move(scratch).value());
  const std::string link = scratch_.back().File(name);
  std::error_code error;
  std::filesystem::create_hard_link(path, link, error);
  if (error) return Error{ErrorCode::kWriteFailed, "cannot store the upload: " + error.message()};
  return link;
}

// Returns the request that all imports of the job share. The file is in the job's scratch directory under the
// name with which it was uploaded, because reports show the name.
Result<ImportRequest> JobInputs::ImportRequestFor(const std::string& path, const std::string& name) {
  auto input = LinkUnderName(path, name);
  if (!input) return input.error();
  ImportRequest request;
  request.input = std::move(input).value();
  // The job's deadline ends the import first.
  request.limits.timeout_s = 2 * limits_.timeout_s;
  request.limits.mesh_timeout_s = std::min(request_.options.import_limits.mesh_timeout_s, MostMeshing());
  request.limits.memory_mb = limits_.import_memory_mb;
  request.unit_mm = request_.options.unit_mm;
  request.temp_parent = std::filesystem::path(scratch_.back().path()).parent_path();
  request.execution = execution();
  request.fork_server = watch_.fork_server;
  request.progress = watch_.progress;
  if (watch_.observer != nullptr) {
    request.ended = watch_.observer->importer_ended;
    request.died = watch_.observer->importer_died;
  }
  return request;
}

Result<ImportedFiles> JobInputs::Import(const std::string& path, const std::string& name,
                                        const std::vector<TessellationOptions>& meshes) {
  auto request = ImportRequestFor(path, name);
  if (!request) return request.error();
  request.value().meshes = meshes;
  request.value().model_suffices = true;
  auto files = RunImporter(request.value());
  // The job's deadline ends an importer before the importer's own time limit does.
  if (!files && files.error().code == ErrorCode::kCancelled && watch_.deadline->expired() &&
      request.value().died)
    request.value().died("timeout");
  // The option of the request cannot exceed the limit of the service.
  if (files && files.value().mesh_failure && files.value().mesh_failure->reason == "timeout" &&
      request_.options.import_limits.mesh_timeout_s > MostMeshing())
    files.value().mesh_failure->error.message =
        name + ": meshing took longer than " + NumberText(MostMeshing()) +
        " s, half of what a job may take; use --timeout to allow more, or a coarser --deflection";
  return files;
}

RunOptions JobInputs::Options() const {
  RunOptions options = request_.options;
  options.timeout_s = 0;
  options.accuracy.max_bytes = limits_.max_view_bytes;
  return options;
}

}  // namespace facetless
