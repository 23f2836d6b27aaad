#include "server/run/own_mesh.h"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "render/base/stopwatch.h"
#include "render/model/model_file.h"
#include "server/base/interrupt.h"
#include "server/base/temp_dir.h"

namespace facetless {
namespace {

// The time to wait for the mesh before exact pictures are made. Most meshes are finished sooner.
constexpr std::chrono::milliseconds kPatience{1000};

class Comparing {
 public:
  Comparing(const ImportRequest& request, const RunOptions& options, const std::string& directory,
            const RunContext& context)
      : request_(request),
        options_(options),
        directory_(directory),
        context_(context),
        importer_stop_(0, request.execution.cancel),
        exact_stop_(0, context.execution.cancel) {
    request_.meshes = {options.tessellation};
    request_.model_suffices = true;
    request_.execution = request.execution.WithFlag(importer_stop_.flag());
    request_.model_written = [this](const std::string& path) { TakeModel(path); };
  }

  Result<OwnMeshComparison> Run() {
    auto scratch = TempDir::Create(request_.temp_parent);
    if (!scratch) return scratch.error();
    scratch_ = std::move(scratch).value();
    {
      const std::jthread importer([this] { Import(); });
      if (MesherTakesLong())
        if (auto made = MakeExactHalf(); !made) {
          importer_stop_.Expire();
          return made.error();
        }
    }
    if (!*files_) return files_->error();
    return Finish(std::move(*files_).value());
  }

 private:
  // ---- These methods run on the importer's thread ----

  void Import() {
    auto files = RunImporter(request_);
    const bool has_mesh = files.ok() && !files.value().mesh_failure;
    const std::lock_guard lock(mutex_);
    files_ = std::move(files);
    // Stop making the exact pictures if there is a mesh or the import failed: then they are not used.
    if (has_mesh || !*files_) exact_stop_.Expire();
    changed_.notify_all();
  }

  // Copies the model file, because the importer still runs and could change it.
  void TakeModel(const std::string& path) {
    std::error_code error;
    std::filesystem::copy_file(path, ModelCopy(), error);
    const std::lock_guard lock(mutex_);
    model_ready_ = !error;
    changed_.notify_all();
  }

  // ---- These methods run on the caller's thread ----

  std::string ModelCopy() const { return scratch_.File("model.flm"); }

  bool MesherTakesLong() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return files_ || model_ready_; });
    if (!files_) changed_.wait_for(lock, kPatience, [&] { return files_.has_value(); });
    return !files_;
  }

  // Makes the exact pictures, unless the mesh is finished first.
  Result<void> MakeExactHalf() {
    imported_.import_ms = stopwatch_.Milliseconds();
    if (auto read = Read(ModelCopy()); !read) return read;
    auto report = RunWithoutBaseline(imported_, PendingBaseline(imported_.model->info.file), options_,
                                     directory_, {context_.execution.WithFlag(exact_stop_.flag()), nullptr});
    if (report) {
      exact_ = std::move(report).value();
    } else if (!exact_stop_.expired()) {
      return report.error();
    }
    return {};
  }

  Result<OwnMeshComparison> Finish(ImportedFiles files) {
    imported_.import_ms = files.wall_ms;
    imported_.import_peak_bytes = files.peak_bytes;
    imported_.import_peak_address_bytes = files.peak_address_bytes;
    // The exact half has read it already, where there is one: the importer does not touch the model after it has
    // written it.
    if (imported_.model == nullptr)
      if (auto read = Read(files.model_path); !read) return read.error();
    if (files.mesh_failure) return WithoutBaseline(NoBaselineFor(*files.mesh_failure));
    const Stopwatch load;
    auto mesh = LoadOwnMesh(files.mesh_paths.front(), *imported_.model);
    if (!mesh) {
      if (!CostsTheBaselineOnly(mesh.error().code)) return mesh.error();
      return WithoutBaseline(NoBaselineFor(mesh.error()));
    }
    imported_.load_ms += load.Milliseconds();
    auto report = RunCompare(imported_, mesh.value(), options_, directory_, context_);
    if (!report) return report.error();
    return OwnMeshComparison{std::move(report).value(), mesh.value().faces_unmeshed};
  }

  // The one place where the model is read.
  Result<void> Read(const std::string& path) {
    const Stopwatch load;
    auto model = ReadModel(path);
    if (!model) return model.error();
    imported_.model = std::make_unique<const Model>(std::move(model).value());
    imported_.load_ms = load.Milliseconds();
    return {};
  }

  Result<OwnMeshComparison> WithoutBaseline(const NoBaseline& why) {
    auto report = exact_ ? WithReason(std::move(*exact_), why, directory_)
                         : RunWithoutBaseline(imported_, why, options_, directory_, context_);
    if (!report) return report.error();
    return OwnMeshComparison{std::move(report).value(), {}};
  }

  ImportRequest request_;
  const RunOptions& options_;
  const std::string directory_;
  const RunContext& context_;
  const Stopwatch stopwatch_;
  TempDir scratch_;
  Deadline importer_stop_, exact_stop_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool model_ready_ = false;
  std::optional<Result<ImportedFiles>> files_;
  ImportedModel imported_;  // its model is null until it is read
  std::optional<RunResult> exact_;
};

}  // namespace

Result<OwnMeshComparison> CompareWithOwnMesh(const ImportRequest& request, const RunOptions& options,
                                             const std::string& directory, const RunContext& context) {
  return Comparing(request, options, directory, context).Run();
}

}  // namespace facetless
