// What a job works on: its model, and for a comparison its mesh, from the store or from the importer.
//
//  1. What is in the store is not made again, and what is made goes in before anything else is done with it:
//     after a crash, or at a second attempt, work goes on where it was.
//  2. The model's file is read once at most: the importer's is described and then used, not read again.
//  3. Meshing may take half of the job's time at most, so that time is left for the exact half.
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

// A mesh to compare with, or why there is none.
struct ComparisonMesh {
  std::optional<Mesh> mesh;
  NoBaseline none;
};

class JobInputs {
 public:
  // All must outlive it.
  JobInputs(const Job& job, JobRequest request, Store& store, const RunLimits& limits, const JobWatch& watch)
      : job_(job), request_(std::move(request)), store_(store), limits_(limits), watch_(watch) {}

  // Finds the model, or imports its file. Errors: those of the importer and of ReadModel, kWriteFailed.
  Result<void> MakeModel();
  // Requires that MakeModel has succeeded.
  const StoredModel& stored() const { return *stored_; }
  // The model in memory. Errors: those of ReadModel.
  Result<const ImportedModel*> Model();
  // The mesh that was posted, or one of our own, which is made if it is not there. Errors: as for MakeModel, and
  // those of LoadMesh.
  Result<ComparisonMesh> MakeMesh();

  // Of another import of the same file, for a run that makes its own.
  Result<ImportRequest> AnotherImport() { return ImportRequestFor(stored_->source_path, stored_->name); }
  // Those of the request, within what the service allows: the job's own deadline ends a run.
  RunOptions Options() const;
  RunContext Context() const { return {execution(), watch_.progress}; }

  const JobRequest& request() const { return request_; }
  const RunLimits& limits() const { return limits_; }
  // Tells the caller on the way.
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
  std::string source_id_;  // of the file, where the model is read in another unit than its own
  std::optional<StoredModel> stored_;
  ImportedModel imported_;  // its model is null until it is read
  std::optional<StoredFile> posted_mesh_;
  std::optional<NoBaseline> no_baseline_;  // of a tessellation that was not made
  std::vector<TempDir> scratch_;
};

}  // namespace facetless
