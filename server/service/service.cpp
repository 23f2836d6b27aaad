#include "server/service/service.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

#include "render/baseline/mesh_file.h"
#include "render/model/model_file.h"
#include "server/files.h"
#include "server/service/problem.h"
#include "server/service/routes.h"
#include "server/service/web_assets.h"
#include "server/sha256.h"
#include "server/version.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// Nothing but the service's own files, and nobody may frame it.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
    "'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";
// A report carries its script and pictures itself, and names from files that strangers made: it runs as an
// origin of its own.
constexpr const char* kArtifactPolicy =
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data:; base-uri 'none'";

const char* ContentTypeOf(const std::string& extension) {
  static const std::pair<const char*, const char*> kTypes[] = {{"png", "image/png"},
                                                               {"tif", "image/tiff"},
                                                               {"exr", "image/x-exr"},
                                                               {"json", "application/json"},
                                                               {"html", "text/html; charset=utf-8"},
                                                               {"glb", "model/gltf-binary"}};
  for (const auto& [known, type] : kTypes) {
    if (extension == known) return type;
  }
  return "application/octet-stream";
}

HttpResponse JsonResponse(int status, const Json& json) {
  HttpResponse response;
  response.status = status;
  response.content_type = "application/json";
  response.body = JsonText(json) + "\n";
  response.headers = {{"Cache-Control", "no-store"}};
  return response;
}

// True if If-None-Match names the tag, or any.
bool Matches(const std::string& if_none_match, const std::string& tag) {
  return if_none_match == "*" || if_none_match.find(tag) != std::string::npos;
}

const BodyPart* FindPart(const HttpRequest& request, const std::string& name) {
  const auto found = std::find_if(request.parts.begin(), request.parts.end(),
                                  [&](const BodyPart& part) { return part.name == name; });
  return found == request.parts.end() ? nullptr : &*found;
}

Json ModelAnswer(const StoredModel& model) {
  return {{"id", model.id},
          {"name", model.name},
          {"bytes", model.bytes},
          {"model", model.report},
          {"links", {{"self", "/v1/models/" + model.id}}}};
}

// Cuts the directories of paths that begin with `prefix`, so that messages name files and not where they lie.
std::string WithoutDirectories(std::string message, const std::string& prefix) {
  if (prefix.empty()) return message;
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) {
    const std::size_t end = std::min(message.find_first_of(" :,;\"'", at), message.size());
    const std::size_t slash = message.rfind('/', end - 1);
    message.erase(at, slash + 1 - at);
  }
  return message;
}

const Error kStoppedWaiting = {ErrorCode::kCancelled, "stopped while waiting for other runs"};

// How a mesh of ours was made, as a key of the store.
std::string MeshKey(const TessellationOptions& mesh) {
  const Json identity = {{"version", Version()},
                         {"deflection", mesh.deflection_mm > 0 ? 0 : mesh.deflection},
                         {"deflection_mm", mesh.deflection_mm},
                         {"angular_deg", mesh.angular_deg}};
  return Sha256Hex(JsonText(identity, -1));
}

Error Malformed(const std::string& message) {
  return {ErrorCode::kBadUsage, message};
}

// What a request for a run asks for, whichever way it came.
struct RunRequest {
  const BodyPart* file = nullptr;  // the model, if it was uploaded with the request
  const BodyPart* mesh = nullptr;
  std::string model_id;        // else the one that is here already
  Json json = Json::object();  // the options as given
  RunOptions options;
};

Result<Json> ParseObject(const std::string& text, const std::string& what) {
  Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded() || !json.is_object()) return Malformed(what + " must be a JSON object");
  return json;
}

Result<RunRequest> ParseRunRequest(const HttpRequest& request, bool compare) {
  RunRequest run;
  const bool multipart = request.Header("content-type").starts_with("multipart/");
  if (multipart) {
    for (const BodyPart& part : request.parts) {
      if (part.name == "file") {
        run.file = &part;
      } else if (part.name == "mesh" && compare) {
        run.mesh = &part;
      } else if (part.name == "model") {
        run.model_id = part.text;
      } else if (part.name == "options") {
        auto json = ParseObject(part.text, "the part \"options\"");
        if (!json) return json.error();
        run.json = std::move(json).value();
      } else {
        return Malformed("there is no part \"" + part.name + "\"; the parts are file or model, options" +
                         (compare ? " and mesh" : ""));
      }
    }
  } else {
    auto json = ParseObject(request.parts.empty() ? "" : request.parts.front().text, "the body");
    if (!json) return json.error();
    run.json = std::move(json).value();
    if (run.json.contains("model")) {
      if (!run.json["model"].is_string()) return Malformed("model must be the id that POST /v1/models gave");
      run.model_id = run.json["model"].get<std::string>();
      run.json.erase("model");
    }
  }
  if ((run.file != nullptr) == !run.model_id.empty())
    return Malformed(
        "give either a file (multipart part \"file\") or a model (the id that POST /v1/models gave)");

  // Options that make sense on the caller's own machine only.
  for (const char* name :
       {"mesh", "threads", "timeout", "import_timeout", "import-timeout", "import_memory", "import-memory"}) {
    if (run.json.contains(name)) return Malformed(std::string(name) + " is no option of the service");
  }
  auto options = ParseOptions(run.json);
  if (!options) return options.error();
  run.options = std::move(options).value();
  return run;
}

}  // namespace

// A place among the runs. Waits for one; released by the destructor.
class Service::Slot {
 public:
  Slot(Service& service, const Deadline& deadline) : service_(service) {
    std::unique_lock lock(service_.mutex_);
    if (service_.running_ >= service_.limits_.jobs && service_.waiting_ >= service_.limits_.queue) {
      busy_ = true;
      return;
    }
    ++service_.waiting_;
    while (service_.running_ >= service_.limits_.jobs && !*deadline.flag())
      service_.slot_freed_.wait_for(lock, std::chrono::milliseconds(50));
    --service_.waiting_;
    if (*deadline.flag()) return;
    ++service_.running_;
    held_ = true;
  }
  ~Slot() {
    if (!held_) return;
    const std::lock_guard lock(service_.mutex_);
    --service_.running_;
    service_.slot_freed_.notify_one();
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  bool held() const { return held_; }
  bool busy() const { return busy_; }

 private:
  Service& service_;
  bool held_ = false, busy_ = false;
};

namespace {

HttpResponse Busy() {
  HttpResponse response =
      Problem(503, "busy", "The service is busy", "Too many requests are waiting; try again soon.");
  response.headers.emplace_back("Retry-After", "5");
  return response;
}

}  // namespace

Service::Service(Store& store, const ServiceLimits& limits, const std::atomic<bool>& stop)
    : store_(store), limits_(limits), stop_(stop) {}

std::optional<HttpResponse> Service::Check(const HttpRequest& request) const {
  const Route route = FindRoute(request.path);
  if (route.kind == RouteKind::kNone) return ProblemOfStatus(404);
  const std::string& method = request.method;
  const bool read = method == "GET" || method == "HEAD";
  if (route.post ? method != "POST" : !read) {
    HttpResponse response = ProblemOfStatus(405);
    response.headers.emplace_back("Allow", route.post ? "POST" : "GET, HEAD");
    return response;
  }
  if (read) return std::nullopt;

  // A page of another site must not use the visitor's browser to give us work.
  if (request.Header("sec-fetch-site") == "cross-site")
    return Problem(403, "cross-site", "Cross-site request",
                   "Requests from pages of other sites are refused.");
  const std::string type = request.Header("content-type");
  const bool raw_allowed = route.kind == RouteKind::kModels;
  if (!raw_allowed && !type.starts_with("multipart/form-data") && !type.starts_with("application/json"))
    return Problem(415, "unsupported-media-type", "Unsupported media type",
                   "Send multipart/form-data with a part \"file\", or application/json with a \"model\".");
  const std::string length = request.Header("content-length");
  if (std::strtoull(length.c_str(), nullptr, 10) > limits_.max_upload_bytes)
    return Problem(413, "payload-too-large", "Payload too large",
                   "The body is larger than " + std::to_string(limits_.max_upload_bytes >> 20) + " MB.");
  const std::lock_guard lock(mutex_);
  if (running_ >= limits_.jobs && waiting_ >= limits_.queue) return Busy();
  return std::nullopt;
}

HttpResponse Service::Handle(const HttpRequest& request) {
  const Route route = FindRoute(request.path);
  switch (route.kind) {
    case RouteKind::kPage:
      return Page(route.argument, route.content_type);
    case RouteKind::kHealth:
      return Health();
    case RouteKind::kModels:
      return PostModel(request);
    case RouteKind::kModel:
      return GetModel(route.argument);
    case RouteKind::kRender:
      return PostRun(request, false);
    case RouteKind::kCompare:
      return PostRun(request, true);
    case RouteKind::kArtifact:
      return Artifact(request, route.argument);
    case RouteKind::kNone:
      break;
  }
  return ProblemOfStatus(404);
}

HttpResponse Service::Health() const {
  const std::lock_guard lock(mutex_);
  return JsonResponse(
      200, {{"status", "ok"}, {"version", Version()}, {"running", running_}, {"waiting", waiting_}});
}

HttpResponse Service::Page(const std::string& name, const std::string& content_type) const {
  HttpResponse response;
  response.content_type = content_type;
  response.body = WebAsset(name);
  response.headers = {{"Content-Security-Policy", kPagePolicy}, {"Cache-Control", "no-cache"}};
  return response;
}

HttpResponse Service::Artifact(const HttpRequest& request, const std::string& name) {
  const auto artifact = store_.FindArtifact(name);
  if (!artifact) return ProblemOfStatus(404);
  const std::string tag = "\"" + name.substr(0, 64) + "\"";
  HttpResponse response;
  response.headers = {{"ETag", tag},
                      {"Cache-Control", "public, max-age=31536000, immutable"},
                      {"Content-Security-Policy", kArtifactPolicy},
                      {"Accept-Ranges", "none"}};
  if (Matches(request.Header("if-none-match"), tag)) {
    response.status = 304;
    return response;
  }
  response.content_type = ContentTypeOf(name.substr(65));
  response.file_path = artifact->path;
  return response;
}

HttpResponse Service::GetModel(const std::string& id) {
  const auto model = store_.FindModel(id);
  return model ? JsonResponse(200, ModelAnswer(*model)) : ProblemOfStatus(404);
}

HttpResponse Service::PostModel(const HttpRequest& request) {
  const BodyPart* file = FindPart(request, "file");
  if (file == nullptr && request.parts.size() == 1 && request.parts[0].name.empty()) file = &request.parts[0];
  if (file == nullptr || file->path.empty())
    return ProblemOf(Malformed("send the file as the body, or as the part \"file\" of multipart/form-data"));
  const Deadline deadline(limits_.timeout_s, &stop_);
  const auto answer = [](int status, const StoredModel& model) {
    HttpResponse response = JsonResponse(status, ModelAnswer(model));
    response.headers.emplace_back("Location", "/v1/models/" + model.id);
    return response;
  };
  // The same file again is free.
  if (auto known = store_.FindModel(file->sha256)) return answer(200, *known);
  const Slot slot(*this, deadline);
  if (!slot.held()) return slot.busy() ? Busy() : Failed(kStoppedWaiting, deadline);
  auto model = ImportModel(*file, deadline, std::nullopt);
  if (!model) return Failed(model.error(), deadline);
  return answer(201, model.value());
}

HttpResponse Service::PostRun(const HttpRequest& request, bool compare) {
  auto parsed = ParseRunRequest(request, compare);
  if (!parsed) return ProblemOf(parsed.error());
  const RunRequest& run = parsed.value();
  const bool foreign = run.mesh != nullptr;
  const Deadline deadline(limits_.timeout_s, &stop_);
  const std::string id = run.file != nullptr ? run.file->sha256 : run.model_id;

  // The same request again is free.
  const Json identity = {{"version", Version()},
                         {"compare", compare},
                         {"model", id},
                         {"mesh", foreign ? run.mesh->sha256 : ""},
                         {"options", run.json}};
  const std::string key = Sha256Hex(JsonText(identity, -1));
  if (auto known = store_.FindResult(key)) return JsonResponse(200, *known);
  auto model = store_.FindModel(id);
  if (!model && run.file == nullptr)
    return Problem(404, "not-found", "Not found", "There is no model " + run.model_id + ".");

  // Import what is new, with its mesh on the way, and run.
  const Slot slot(*this, deadline);
  if (!slot.held()) return slot.busy() ? Busy() : Failed(kStoppedWaiting, deadline);
  const std::optional<TessellationOptions> own_mesh =
      compare && !foreign ? std::optional(run.options.tessellation) : std::nullopt;
  if (!model) {
    auto imported = ImportModel(*run.file, deadline, own_mesh);
    if (!imported) return Failed(imported.error(), deadline);
    model = std::move(imported).value();
  }
  std::string mesh_path = foreign ? run.mesh->path : "";
  if (own_mesh) {
    auto ensured = EnsureMesh(*model, *own_mesh, deadline);
    if (!ensured) return Failed(ensured.error(), deadline);
    mesh_path = std::move(ensured).value();
  }
  auto report = Execute(*model, mesh_path, run.options, compare, deadline);
  if (!report) return Failed(report.error(), deadline);
  if (auto kept = store_.PutResult(key, report.value()); !kept) return Failed(kept.error(), deadline);
  return JsonResponse(200, report.value());
}

Result<Json> Service::Execute(const StoredModel& model, const std::string& mesh_path,
                              const RunOptions& options, bool compare, const Deadline& deadline) {
  auto read = ReadModel(model.model_path);
  if (!read) return read.error();
  ImportedModel imported;
  imported.model = std::make_unique<const Model>(std::move(read).value());
  imported.import_ms = model.report.value("import_ms", 0.0);
  imported.import_peak_bytes = model.report.value("import_peak_bytes", std::uint64_t{0});

  // How much work is asked for.
  auto cameras = ResolveCameras(options, imported.model->bounds);
  if (!cameras) return cameras.error();
  std::uint64_t samples = 0;
  for (const Camera& camera : cameras.value())
    samples +=
        std::uint64_t(camera.width_px) * std::uint64_t(camera.height_px) * std::uint64_t(options.samples);
  if (samples > limits_.max_samples)
    return Error{ErrorCode::kLimitExceeded, "the request asks for " + std::to_string(samples) +
                                                " samples (pixels × samples per pixel × views), and " +
                                                std::to_string(limits_.max_samples) + " are allowed"};

  // Run into a directory of its own, then move its files into the store.
  auto scratch = store_.Scratch();
  if (!scratch) return scratch.error();
  const std::string out = scratch.value().File("out");
  const RunContext context = {deadline.flag(), {}};
  if (!compare) {
    auto report = RunRender(imported, options, out, context);
    return report ? Publish(std::move(report).value(), out, model.id) : report;
  }
  auto mesh = LoadMesh(mesh_path, {.unit = options.mesh_unit, .up = options.mesh_up}, imported.model.get());
  if (!mesh) return mesh.error();
  auto report = RunCompare(imported, mesh.value(), options, out, context);
  return report ? Publish(std::move(report).value(), out, model.id) : report;
}

Result<StoredModel> Service::ImportModel(const BodyPart& file, const Deadline& deadline,
                                         const std::optional<TessellationOptions>& mesh) {
  // Give the importer the file under the name that it came with: reports show it.
  const std::string name = SafeFileName(file.file_name);
  auto scratch = store_.Scratch();
  if (!scratch) return scratch.error();
  const std::string source = scratch.value().File(name);
  std::error_code error;
  std::filesystem::create_hard_link(file.path, source, error);
  if (error) return Error{ErrorCode::kWriteFailed, "cannot store the upload: " + error.message()};
  std::vector<TessellationOptions> meshes;
  if (mesh) meshes.push_back(*mesh);
  auto files = RunImport(source, meshes, deadline);
  if (!files) return files.error();

  // Describe it and keep it.
  auto model = ReadModel(files.value().model_path);
  if (!model) return model.error();
  ImportedModel imported;
  imported.model = std::make_unique<const Model>(std::move(model).value());
  imported.import_ms = files.value().wall_ms;
  imported.import_peak_bytes = files.value().peak_bytes;
  auto stored =
      store_.PutModel(file.sha256, name, ImportedModelJson(imported), source, files.value().model_path);
  if (!stored || !mesh) return stored;
  auto kept = store_.PutMesh(file.sha256, MeshKey(*mesh), files.value().mesh_paths.front());
  if (!kept) return kept.error();
  return stored;
}

Result<std::string> Service::EnsureMesh(const StoredModel& model, const TessellationOptions& mesh,
                                        const Deadline& deadline) {
  const std::string key = MeshKey(mesh);
  if (auto known = store_.FindMesh(model.id, key)) return *known;
  auto files = RunImport(model.source_path, {mesh}, deadline);
  if (!files) return files.error();
  return store_.PutMesh(model.id, key, files.value().mesh_paths.front());
}

Result<ImportedFiles> Service::RunImport(const std::string& path,
                                         const std::vector<TessellationOptions>& meshes,
                                         const Deadline& deadline) {
  auto scratch = store_.Scratch();
  if (!scratch) return scratch.error();
  ImportRequest request;
  request.input = path;
  request.meshes = meshes;
  // The request's deadline ends it first, and answers 504.
  request.limits.timeout_s = 2 * limits_.timeout_s;
  request.limits.memory_mb = limits_.import_memory_mb;
  request.temp_parent = std::filesystem::path(scratch.value().path()).parent_path();
  request.cancel = deadline.flag();
  return RunImporter(request);
}

Result<Json> Service::Publish(Json report, const std::string& directory, const std::string& id) {
  for (Json& view : report["views"]) {
    Json links = Json::object();
    for (const auto& [role, file] : view["files"].items()) {
      const std::string name = file.get<std::string>();
      auto artifact = store_.PutArtifact(directory + "/" + name, name.substr(name.rfind('.') + 1));
      if (!artifact) return artifact.error();
      links[role] = "/v1/artifacts/" + artifact.value();
    }
    view["links"] = std::move(links);
  }
  report["links"] = {{"model", "/v1/models/" + id}};
  for (const auto& [role, name] : {std::pair{"report", "report.json"}, {"page", "report.html"}}) {
    auto artifact = store_.PutArtifact(directory + "/" + name, std::string(name).substr(7));
    if (!artifact) return artifact.error();
    report["links"][role] = "/v1/artifacts/" + artifact.value();
  }
  return report;
}

HttpResponse Service::Failed(const Error& error, const Deadline& deadline) const {
  if (error.code == ErrorCode::kCancelled && deadline.expired())
    return Problem(504, "timeout", "The request took too long",
                   "It was stopped after " + std::to_string(static_cast<long>(limits_.timeout_s)) + " s.");
  if (error.code == ErrorCode::kCancelled)
    return Problem(503, "shutting-down", "The service is shutting down", "Try again soon.");
  return ProblemOf({error.code, WithoutDirectories(error.message, limits_.private_directory)});
}

}  // namespace facetless
