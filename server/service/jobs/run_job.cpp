#include "server/service/jobs/run_job.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "render/base/stopwatch.h"
#include "render/baseline/mesh_file.h"
#include "render/model/model_file.h"
#include "render/trade/quantity_text.h"
#include "server/base/files.h"
#include "server/base/sha256.h"
#include "server/base/version.h"
#include "server/run/run.h"
#include "server/run/trade.h"
#include "server/service/jobs/submission.h"
#include "server/service/protocol/http_terms.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using Artifacts = std::vector<std::pair<std::string, KeptFile>>;

// If the caller of a trade gives no budget, the budget lets at least this many points fit into the job's
// time.
constexpr double kTradePoints = 20;

// Returns the settings with which a mesh of ours was made, as a key of the store.
std::string MeshKey(const TessellationOptions& mesh) {
  const Json identity = {{"version", Version()},
                         {"deflection", mesh.deflection_mm > 0 ? 0 : mesh.deflection},
                         {"deflection_mm", mesh.deflection_mm},
                         {"angular_deg", mesh.angular_deg}};
  return Sha256Hex(JsonText(identity, -1));
}

// Reports the number of rays and the time of the direct renderer to the observer, view by view. A trade's
// report has no such times.
void ReportTracing(const Json& report, const Observer* observer) {
  if (observer == nullptr || !observer->traced) return;
  for (const Json& view : report.value("views", Json::array())) {
    if (!view.contains("direct") || !view["direct"].contains("timing_ms")) continue;
    const Json& direct = view["direct"];
    constexpr double kMillisecond = 1e-3;
    observer->traced(direct.value("rays", 0.0), direct["timing_ms"].value("trace", 0.0) * kMillisecond);
  }
}

// Moves the files of a run into the store, and links them in its report.
class Publication {
 public:
  Publication(Store& store, std::string directory) : store_(store), directory_(std::move(directory)) {}

  // Stores a file of the run, and returns its address.
  Result<std::string> Add(const std::string& name) {
    auto kept = store_.Keep(directory_ + "/" + name, "");
    if (!kept) return kept.error();
    const std::string artifact = kept.value().sha256 + "." + name.substr(name.rfind('.') + 1);
    artifacts_.emplace_back(artifact, std::move(kept).value());
    return "/v1/artifacts/" + artifact;
  }
  // Adds `links[role]`.
  Result<void> Link(Json& links, const std::string& role, const std::string& name) {
    auto address = Add(name);
    if (!address) return address.error();
    links[role] = std::move(address).value();
    return {};
  }
  const Artifacts& artifacts() const { return artifacts_; }

 private:
  Store& store_;
  const std::string directory_;
  Artifacts artifacts_;
};

class JobRun {
 public:
  JobRun(const Job& job, Store& store, const RunLimits& limits, const JobWatch& watch)
      : job_(job), store_(store), limits_(limits), watch_(watch) {}

  Result<std::string> Run() {
    auto parsed = ParseJobRequest(job_.request);
    if (!parsed) return parsed.error();
    request_ = std::move(parsed).value();
    const std::string answer = AnswerItem(job_.owner, job_.question);
    if (job_.kind != "model" && store_.FindAnswer(job_.owner, job_.question)) return answer;

    // First make the model, and the mesh to compare it with. A job that was queued before the service
    // restarted may exceed the limits that apply now.
    if (job_.kind != "model")
      if (auto small = CheckSamples(request_.options, limits_.max_samples); !small) return small.error();
    if (auto ready = MakeModel(); !ready) return ready.error();
    if (job_.kind == "model") return ModelItem(job_.owner, request_.model_id);
    std::string mesh_path;
    if (job_.kind == "comparison") {
      auto made = MakeMesh();
      if (!made) return made.error();
      mesh_path = std::move(made).value();
    }
    if (auto run = Execute(mesh_path); !run) return run.error();
    return answer;
  }

 private:
  bool foreign_mesh() const { return !request_.mesh.empty(); }

  // A file that is read in another unit than its own is another model. Sets request_.model_id to the id of
  // that model, and source_id_ to the model or the upload that has the file.
  void FindInUnit() {
    if (request_.options.unit_mm == 0 || job_.kind == "model") return;
    if (const auto own = store_.FindModel(job_.owner, request_.model_id); own && request_.file_name.empty())
      request_.file_name = own->name;
    source_id_ = request_.model_id;
    const Json identity = {{"model", request_.model_id}, {"unit_mm", request_.options.unit_mm}};
    request_.model_id = Sha256Hex(JsonText(identity, -1));
  }

  Result<void> MakeModel() {
    FindInUnit();
    model_ = store_.FindModel(job_.owner, request_.model_id);
    if (model_) return {};
    if (request_.file_name.empty())
      return Error{ErrorCode::kFileUnreadable, "the model " + request_.model_id + " no longer exists"};
    const auto source = store_.Pin(source_id_.empty() ? request_.model_id : source_id_);
    if (!source) return Error{ErrorCode::kInternal, "the uploaded file no longer exists"};

    // Import the file and, for a comparison, make the mesh in the same run of the importer.
    std::vector<TessellationOptions> meshes;
    if (job_.kind == "comparison" && !foreign_mesh()) meshes.push_back(request_.options.tessellation);
    auto files = Import(source->path, request_.file_name, meshes);
    if (!files) return files.error();
    imported_ = true;

    // Describe the model and store it.
    auto read = ReadModel(files.value().model_path);
    if (!read) return read.error();
    ImportedModel imported;
    imported.model = std::make_unique<const Model>(std::move(read).value());
    imported.import_ms = files.value().wall_ms;
    imported.import_peak_bytes = files.value().peak_bytes;
    auto model_file = store_.Keep(files.value().model_path, "");
    if (!model_file) return model_file.error();
    if (auto put = store_.PutModel(job_.owner, request_.model_id, request_.file_name,
                                   ImportedModelJson(imported), *source, model_file.value());
        !put)
      return put;
    if (!meshes.empty()) {
      auto kept = KeepMesh(files.value(), request_.model_id);
      if (!kept) return kept.error();
    }
    model_ = store_.FindModel(job_.owner, request_.model_id);
    if (!model_) return Error{ErrorCode::kWriteFailed, "the model cannot be read back"};
    const std::size_t lost = LossCount(*imported.model);
    if (lost > 0 && watch_.message)
      watch_.message(std::to_string(lost) + " faces, loops or edges of the file were lost");
    return {};
  }

  // Stores the mesh of an import that had to make one, and returns its path. If there is none, stores the
  // reason and returns "".
  Result<std::string> KeepMesh(const ImportedFiles& files, const std::string& model_id) {
    if (files.mesh_failure) {
      no_baseline_ = NoBaselineFor(*files.mesh_failure);
      return std::string();
    }
    auto mesh = store_.Keep(files.mesh_paths.front(), "");
    if (!mesh) return mesh.error();
    const std::string key = MeshKey(request_.options.tessellation);
    if (auto put = store_.PutMesh(job_.owner, model_id, key, mesh.value()); !put) return put.error();
    return mesh.value().path;
  }

  // Finds or makes the mesh, and returns its path; "" if there is none, and then no_baseline_ has the reason.
  Result<std::string> MakeMesh() {
    if (no_baseline_) return std::string();
    if (foreign_mesh()) {
      posted_mesh_ = store_.Pin(request_.mesh);
      if (!posted_mesh_) return Error{ErrorCode::kInternal, "the uploaded mesh no longer exists"};
      // Link it under the name with which it was uploaded, because errors show that name.
      auto path = UnderName(posted_mesh_->path, request_.mesh_name.empty() ? "mesh" : request_.mesh_name);
      if (!path) return path.error();
      return std::move(path).value();
    }
    const std::string key = MeshKey(request_.options.tessellation);
    if (auto known = store_.FindMesh(job_.owner, model_->id, key)) return *known;
    auto files = Import(model_->source_path, model_->name, {request_.options.tessellation});
    if (!files) return files.error();
    return KeepMesh(files.value(), model_->id);
  }

  // Links the file at `path` into a new scratch directory of the job under `name`. Returns the path of the
  // link.
  Result<std::string> UnderName(const std::string& path, const std::string& name) {
    auto scratch = store_.Scratch();
    if (!scratch) return scratch.error();
    scratch_.push_back(std::move(scratch).value());
    const std::string link = scratch_.back().File(name);
    std::error_code error;
    std::filesystem::create_hard_link(path, link, error);
    if (error) return Error{ErrorCode::kWriteFailed, "cannot store the upload: " + error.message()};
    return link;
  }

  // Returns the import request for the file at `path`, which is linked into a scratch directory of the job
  // under `name`, because reports show that name.
  Result<ImportRequest> ImportRequestFor(const std::string& path, const std::string& name) {
    auto input = UnderName(path, name);
    if (!input) return input.error();
    ImportRequest request;
    request.input = std::move(input).value();
    // This limit is never reached, because the job's deadline ends the import first.
    request.limits.timeout_s = 2 * limits_.timeout_s;
    request.limits.mesh_timeout_s = std::min(request_.options.import_limits.mesh_timeout_s, MostMeshing());
    request.limits.memory_mb = limits_.import_memory_mb;
    request.unit_mm = request_.options.unit_mm;
    request.temp_parent = std::filesystem::path(scratch_.back().path()).parent_path();
    request.cancel = watch_.deadline->flag();
    request.progress = watch_.progress;
    if (watch_.observer != nullptr) request.died = watch_.observer->importer_died;
    return request;
  }

  // Returns the time limit of meshing in seconds (law 2).
  double MostMeshing() const { return limits_.timeout_s / 2; }

  Result<ImportedFiles> Import(const std::string& path, const std::string& name,
                               const std::vector<TessellationOptions>& meshes) {
    auto request = ImportRequestFor(path, name);
    if (!request) return request.error();
    request.value().meshes = meshes;
    request.value().model_suffices = true;
    auto files = RunImporter(request.value());
    // The job's deadline ends an importer before the importer's own deadline, so the cause is reported here.
    if (!files && files.error().code == ErrorCode::kCancelled && watch_.deadline->expired() &&
        request.value().died)
      request.value().died("timeout");
    // The request's mesh_timeout cannot exceed the limit of the service, so the error names the latter.
    if (files && files.value().mesh_failure && files.value().mesh_failure->reason == "timeout" &&
        request_.options.import_limits.mesh_timeout_s > MostMeshing())
      files.value().mesh_failure->error.message = name + ": meshing took longer than " +
                                                  NumberText(MostMeshing()) +
                                                  " s, half of what a job may take; use --timeout to allow "
                                                  "more, and a coarser --deflection needs less";
    return files;
  }

  Result<void> Execute(const std::string& mesh_path) {
    const Stopwatch stopwatch;
    auto read = ReadModel(model_->model_path);
    if (!read) return read.error();
    ImportedModel imported;
    imported.import_kept = !imported_;
    imported.load_ms = stopwatch.Milliseconds();
    imported.model = std::make_unique<const Model>(std::move(read).value());
    imported.import_ms = model_->report.value("import_ms", 0.0);
    imported.import_peak_bytes = model_->report.value("import_peak_bytes", std::uint64_t{0});

    // Write the results into a separate directory, then move the files into the store.
    auto scratch = store_.Scratch();
    if (!scratch) return scratch.error();
    const std::string out = scratch.value().File("out");
    auto report = Report(imported, mesh_path, out);
    if (!report) return report.error();
    ReportTracing(report.value(), watch_.observer);
    return Publish(std::move(report).value(), out);
  }

  // Adds to a report without a baseline the reason in terms of HTTP, which is also sent as a progress
  // message.
  Result<Json> InTermsOfHttp(Result<Json> report, const std::string& out) {
    if (!report || !report.value().contains("no_baseline")) return report;
    const Json& said = report.value().at("no_baseline");
    const NoBaseline why = {said.at("reason"), InHttpTerms(said.at("message").get<std::string>())};
    if (watch_.message) watch_.message(why.message);
    return WithReason(std::move(report).value(), why, out);
  }

  Result<Json> WithoutBaseline(const ImportedModel& imported, const RunOptions& options,
                               const std::string& out, const RunContext& context) {
    return InTermsOfHttp(RunWithoutBaseline(imported, *no_baseline_, options, out, context), out);
  }

  Result<Json> Report(const ImportedModel& imported, const std::string& mesh_path, const std::string& out) {
    const RunContext context = {watch_.deadline->flag(), watch_.progress};
    RunOptions options = request_.options;
    options.timeout_s = 0;  // the job's own deadline ends it
    options.max_view_bytes = limits_.max_view_bytes;
    if (job_.kind == "render") return RunRender(imported, options, out, context);
    if (job_.kind == "comparison") {
      if (mesh_path.empty()) return WithoutBaseline(imported, options, out, context);
      const MeshLoadOptions how = {.unit = request_.options.mesh_unit, .up = request_.options.mesh_up};
      auto mesh = foreign_mesh() ? LoadMesh(mesh_path, how, imported.model.get())
                                 : LoadOwnMesh(mesh_path, *imported.model);
      if (mesh) return InTermsOfHttp(RunCompare(imported, mesh.value(), options, out, context), out);
      if (foreign_mesh() || !CostsTheBaselineOnly(mesh.error().code)) return mesh.error();
      no_baseline_ = NoBaselineFor(mesh.error());
      return WithoutBaseline(imported, options, out, context);
    }
    const double budget_s = limits_.timeout_s / (request_.budget_given ? 1 : kTradePoints);
    options.trade.budget_s = std::min(options.trade.budget_s, budget_s);
    options.trade.budget_mb =
        std::min({options.trade.budget_mb, limits_.import_memory_mb, limits_.max_view_bytes >> 20});
    auto request = ImportRequestFor(model_->source_path, model_->name);
    if (!request) return request.error();
    request.value().progress = nullptr;
    auto result = RunTrade(request.value(), imported, options, out, context);
    if (!result) return result.error();
    return std::move(result).value().report;
  }

  Result<void> Publish(Json report, const std::string& directory) {
    if (watch_.progress) watch_.progress("publish", 0);
    Publication publication(store_, directory);
    for (Json& view : report["views"]) {
      Json links = Json::object();
      for (const auto& [role, file] : view["files"].items()) {
        if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
      }
      const Json plots = view.value("plots", Json::object());
      for (const auto& [cost, files] : plots.items()) {
        for (const auto& [type, file] : files.items()) {
          const std::string role = "trade-" + cost + "." + type;
          if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
        }
      }
      view["links"] = std::move(links);
    }
    if (report.contains("turntable")) {
      Json& turntable = report["turntable"];
      turntable["links"] = Json::array();
      for (const Json& frame : turntable["frames"]) {
        auto address = publication.Add(frame.get<std::string>());
        if (!address) return address.error();
        turntable["links"].push_back(std::move(address).value());
      }
    }
    Json links = {{"model", "/v1/models/" + model_->id}, {"self", "/v1/answers/" + job_.question}};
    const Json files = report.value("files", Json::object());
    for (const auto& [role, file] : files.items()) {
      if (auto linked = publication.Link(links, role, file.get<std::string>()); !linked) return linked;
    }
    for (const auto& [role, name] : {std::pair{"report", "report.json"}, {"page", "report.html"}}) {
      if (auto linked = publication.Link(links, role, name); !linked) return linked;
    }
    report["links"] = std::move(links);
    return store_.PutAnswer(job_.owner, job_.question, JsonText(report) + "\n", publication.artifacts());
  }

  const Job& job_;
  Store& store_;
  const RunLimits& limits_;
  const JobWatch& watch_;
  JobRequest request_;
  std::string source_id_;  // id of the file, if the model is read in another unit than its own
  std::optional<StoredModel> model_;
  bool imported_ = false;  // true: this job imported the model
  std::optional<KeptFile> posted_mesh_;
  std::optional<NoBaseline> no_baseline_;  // set for a comparison whose mesh was not made
  std::vector<TempDir> scratch_;
};

}  // namespace

Result<std::string> RunJob(const Job& job, Store& store, const RunLimits& limits, const JobWatch& watch) {
  return JobRun(job, store, limits, watch).Run();
}

}  // namespace facetless
