// The inputs of a job: its model, and for a comparison its mesh, from the store or from the importer.
//
//  1. An input that is in the store is not made again, and a new input is stored before it is used. After a
//     crash, or at a second attempt, the work therefore continues where it ended.
//  2. The model's file is read at most once. A model that the importer has just made is described and then
//     used without reading its file again.
//  3. Meshing may take at most half of the job's time, so that time remains for the exact half.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/importer/import_process.h"
#include "server/run/run.h"
#include "server/service/jobs/run_job.h"
#include "server/service/jobs/submission.h"
#include "server/service/store/store.h"

namespace facetless {

// The mesh of a comparison, or the reason why there is none.
struct ComparisonMesh {
  std::optional<Mesh> mesh;
  NoBaseline none;
};

class JobInputs {
 public:
  // All arguments must outlive this object.
  JobInputs(const Job& job, JobRequest request, Store& store, const RunLimits& limits, const JobWatch& watch)
      : job_(job), request_(std::move(request)), store_(store), limits_(limits), watch_(watch) {}

  // Finds the model in the store, or imports its file. Errors: those of the importer and of ReadModel,
  // kWriteFailed.
  Result<void> MakeModel();
  // Requires that MakeModel has succeeded.
  const StoredModel& stored() const { return *stored_; }
  // Returns the model in memory. Errors: those of ReadModel.
  Result<const ImportedModel*> Model();
  // Returns the mesh that was posted, or our own tessellation, which is made if it is not in the store.
  // Errors: those of MakeModel and of LoadMesh.
  Result<ComparisonMesh> MakeMesh();

  // Returns a request for another import of the same file, for a run that makes its own.
  Result<ImportRequest> AnotherImport() { return ImportRequestFor(stored_->source_path, stored_->name); }
  // Returns the options of the request, limited to what the service allows. The job's own deadline ends a
  // run.
  RunOptions Options() const;
  RunContext Context() const { return {execution(), watch_.progress}; }

  const JobRequest& request() const { return request_; }
  const RunLimits& limits() const { return limits_; }
  // Sends a sentence to the caller while the job runs.
  void Say(const std::string& sentence) const {
    if (watch_.message) watch_.message(sentence);
  }

 private:
  Execution execution() const { return {request_.options.threads, watch_.deadline->flag()}; }
  bool foreign_mesh() const { return !request_.mesh.empty(); }
  bool wants_tessellation() const;
  double MostMeshing() const { return limits_.timeout_s / 2; }  // seconds, law 3

  void FindInUnit();
  Result<void> Describe(const ImportedFiles& files, const StoredFile& source);
  Result<std::string> StoreMesh(const ImportedFiles& files, const std::string& model_id);
  Result<std::string> MeshPath();
  Result<std::string> LinkUnderName(const std::string& path, const std::string& name);
  Result<ImportRequest> ImportRequestFor(const std::string& path, const std::string& name);
  Result<ImportedFiles> Import(const std::string& path, const std::string& name,
                               const std::vector<TessellationOptions>& meshes);
  Result<void> ReadInto(const std::string& path);

  const Job& job_;
  JobRequest request_;
  Store& store_;
  const RunLimits& limits_;
  const JobWatch& watch_;
  std::string source_id_;  // id of the file, if the model is read in another unit than its own
  std::optional<StoredModel> stored_;
  ImportedModel imported_;  // its model is null until it is read
  std::optional<StoredFile> posted_mesh_;
  std::optional<NoBaseline> no_baseline_;  // reason why a tessellation was not made
  std::vector<TempDir> scratch_;
};

}  // namespace facetless
