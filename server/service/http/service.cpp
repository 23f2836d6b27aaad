#include "server/service/http/service.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "server/base/files.h"
#include "server/base/version.h"
#include "server/base/web_assets.h"
#include "server/run/methods.h"
#include "server/service/http/listing.h"
#include "server/service/jobs/answers.h"
#include "server/service/jobs/routes.h"
#include "server/service/protocol/problem.h"

namespace facetless {
namespace {

using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

// The default time that a caller waits; small runs are done within it.
constexpr double kUsualWaitSeconds = 10;
// The additional time that a request may wait, so that a caller who waits for the whole time limit of a job
// receives its timeout.
constexpr double kEndSeconds = 2;
// Bodies up to this size are read even if the queue is full, because the answer may be known already.
constexpr std::uint64_t kSmallBody = 1 << 20;
// The longest Idempotency-Key. The RFC draft "The Idempotency-Key HTTP Header Field" leaves the length to the
// service.
constexpr std::size_t kMaxRetryKey = 255;
constexpr std::size_t kModelIdDigits = 64, kJobIdDigits = 32;
// The time for which a readiness result is reused, because the check accesses the disk.
constexpr auto kReadyLasts = std::chrono::seconds(1);

// The page may load only files of the service, and no other page may embed it in a frame.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
    "'self'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'";
// A report contains its script and pictures, and names from untrusted files, so it runs in an origin of its
// own.
constexpr const char* kArtifactPolicy =
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data:; base-uri 'none'";

const char* ContentTypeOf(const std::string& extension) {
  static const std::pair<const char*, const char*> kTypes[] = {
      {"png", "image/png"},         {"tif", "image/tiff"},        {"exr", "image/x-exr"},
      {"svg", "image/svg+xml"},     {"json", "application/json"}, {"html", "text/html; charset=utf-8"},
      {"glb", "model/gltf-binary"}, {"webp", "image/webp"}};
  for (const auto& [known, type] : kTypes) {
    if (extension == known) return type;
  }
  return "application/octet-stream";
}

// Returns whether If-None-Match names the tag or any tag.
bool Matches(const std::string& if_none_match, const std::string& tag) {
  return if_none_match == "*" || if_none_match.find(tag) != std::string::npos;
}

HttpResponse Busy(const std::string& detail) {
  HttpResponse response = Problem(503, "busy", "The service is busy", detail);
  response.headers.emplace_back("Retry-After", "5");
  return response;
}

HttpResponse ShuttingDown() {
  HttpResponse response = Problem(503, "shutting-down", "The service is shutting down",
                                  "The service accepts no new requests. Try again soon.");
  response.headers.emplace_back("Retry-After", "5");
  return response;
}

HttpResponse Answer(int status, JobKind kind, const std::string& model_id, std::string text) {
  HttpResponse response = JsonTextResponse(status, std::move(text));
  if (kind == JobKind::kModel) response.headers.emplace_back("Location", "/v1/models/" + model_id);
  return response;
}

// The response for an answer that existed already. timing_ms is that of this request, which only looked the
// answer up; the time of the original work is in kept.timing_ms.
HttpResponse StoredAnswerResponse(JobKind kind, const std::string& model_id, const std::string& text,
                                  Clock::time_point arrived) {
  Json report = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  HttpResponse response;
  if (report.is_object() && report.contains("timing_ms")) {
    const std::chrono::duration<double, std::milli> elapsed = Clock::now() - arrived;
    report["kept"] = {{"timing_ms", std::move(report["timing_ms"])}};
    report["timing_ms"] = {{"total", elapsed.count()}};
    response = Answer(200, kind, model_id, JsonText(report) + "\n");
  } else {
    response = Answer(200, kind, model_id, text);
  }
  // Report the cache hit (RFC 9211).
  response.headers.emplace_back("Cache-Status", "facetless; hit");
  return response;
}

// Sets the job to which a response refers.
HttpResponse SetResponseJob(HttpResponse response, const std::string& id) {
  response.job = id;
  return response;
}

// Occupies one of a limited number of slots as long as the object exists, if there is a free slot.
class ScopedSlot {
 public:
  ScopedSlot(std::atomic<int>& count, int most) : count_(count), held_(++count <= most) {}
  ~ScopedSlot() { --count_; }
  ScopedSlot(const ScopedSlot&) = delete;
  ScopedSlot& operator=(const ScopedSlot&) = delete;
  bool held() const { return held_; }

 private:
  std::atomic<int>& count_;
  const bool held_;
};

bool IsRetryKey(const std::string& key) {
  return key.size() <= kMaxRetryKey &&
         std::all_of(key.begin(), key.end(), [](unsigned char c) { return c >= 0x20 && c < 0x7f; });
}

}  // namespace

Service::Service(Store& store, Jobs& jobs, AccessControl& access, const ServiceLimits& limits)
    : store_(store), jobs_(jobs), access_(access), limits_(limits) {}

std::optional<HttpResponse> Service::Check(HttpRequest& request) {
  if (request.admitted) return std::nullopt;
  const Route route = FindRoute(request.path);
  const bool operations = route.kind == RouteKind::kHealth || route.kind == RouteKind::kReady ||
                          route.kind == RouteKind::kMetrics;
  const bool elsewhere =
      request.operations ? !operations : route.kind == RouteKind::kMetrics && limits_.operations_apart;
  if (route.kind == RouteKind::kNone || elsewhere) return ProblemForStatus(404);
  const std::string& method = request.method;
  if (!route.Allows(method)) {
    HttpResponse response = ProblemForStatus(405);
    response.headers.emplace_back("Allow", route.methods);
    return response;
  }
  if (const std::string why = limits_.hosts.RefusalReason(request.Header("host"), request.Header("origin"));
      !why.empty())
    return Problem(403, "host-not-allowed", "Host or origin not allowed", why);
  if (auto refusal = access_.Decide(request, route)) return refusal;
  if (method == "GET" || method == "HEAD") return std::nullopt;

  // A page of another site must not submit work through its visitor's browser.
  if (request.Header("sec-fetch-site") == "cross-site")
    return Problem(403, "cross-site", "Cross-site request",
                   "Requests from pages of other sites are refused.");
  if (route.kind != RouteKind::kSubmit) return std::nullopt;
  if (jobs_.stopping()) return ShuttingDown();
  const std::string type = request.Header("content-type");
  const bool raw_allowed = route.job == JobKind::kModel;
  if (!raw_allowed && !type.starts_with("multipart/form-data") && !type.starts_with("application/json"))
    return Problem(415, "unsupported-media-type", "Unsupported media type",
                   "Send multipart/form-data with a part \"file\", or application/json with a \"model\".");
  const std::string length = request.Header("content-length");
  const std::uint64_t bytes =
      length.empty() ? limits_.max_upload_bytes : std::strtoull(length.c_str(), nullptr, 10);
  if (bytes > limits_.max_upload_bytes)
    return Problem(413, "payload-too-large", "Payload too large",
                   "The body is larger than " + std::to_string(limits_.max_upload_bytes >> 20) + " MB.");
  if (bytes > kSmallBody && jobs_.Counts().queued >= limits_.queue)
    return Busy("Too many jobs are waiting; try again soon.");
  return std::nullopt;
}

HttpResponse Service::Handle(const HttpRequest& request) {
  const Route route = FindRoute(request.path);
  switch (route.kind) {
    case RouteKind::kPage:
      return Page(route.argument, route.content_type);
    case RouteKind::kHealth:
      return Health();
    case RouteKind::kReady:
      return Ready();
    case RouteKind::kMetrics:
      return MetricsPage();
    case RouteKind::kMethods:
      return JsonResponse(200, MethodsJson());
    case RouteKind::kSubmit:
      return request.method == "POST" ? Submit(request, route.job) : ListModels(request);
    case RouteKind::kModel:
      return request.method == "DELETE" ? RemoveModel(request.caller, route.argument)
                                        : GetModel(request.caller, route.argument);
    case RouteKind::kAnswer:
      return GetAnswer(request.caller, route.argument);
    case RouteKind::kArtifact:
      return Artifact(request, route.argument);
    case RouteKind::kJobs:
      return ListJobs(request);
    case RouteKind::kJob:
      return request.method == "DELETE" ? CancelJob(request.caller, route.argument)
                                        : GetJob(request.caller, route.argument);
    case RouteKind::kJobEvents:
      return JobEvents(request.caller, route.argument);
    case RouteKind::kNone:
      break;
  }
  return ProblemForStatus(404);
}

// ---- Reading ----

HttpResponse Service::Health() {
  const JobCounts counts = jobs_.Counts();
  return JsonResponse(200, {{"status", jobs_.stopping() ? "stopping" : "ok"},
                            {"version", Version()},
                            {"running", counts.running},
                            {"waiting", counts.queued}});
}

HttpResponse Service::Ready() {
  const std::string reason = WhyNotReady();
  if (reason.empty()) return JsonResponse(200, {{"status", "ready"}, {"version", Version()}});
  HttpResponse response = Problem(503, "not-ready", "The service is not ready", reason);
  response.headers = {{"Cache-Control", "no-store"}, {"Retry-After", "5"}};
  return response;
}

std::string Service::WhyNotReady() {
  if (jobs_.stopping()) return "It is stopping.";
  const std::lock_guard lock(ready_mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now < ready_until_) return why_not_ready_;
  why_not_ready_ = !store_.Check()  ? "The store cannot be written."
                   : !jobs_.Check() ? "The queue cannot be written."
                   : store_.FreeBytes() < limits_.max_upload_bytes
                       ? "The disk has less room than one upload may need."
                       : "";
  ready_until_ = now + kReadyLasts;
  return why_not_ready_;
}

HttpResponse Service::MetricsPage() {
  if (!metrics_text) return ProblemForStatus(404);
  const JobCounts counts = jobs_.Counts();
  HttpResponse response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = metrics_text({WhyNotReady().empty(), counts.queued, counts.running, store_.StoredBytes()});
  response.headers = {{"Cache-Control", "no-store"}};
  return response;
}

HttpResponse Service::Page(const std::string& name, const std::string& content_type) const {
  // A name from a path may be any text.
  const bool script = content_type.starts_with("text/javascript");
  if (WebAsset(name).empty() || (script && !name.ends_with(".js"))) return ProblemForStatus(404);
  HttpResponse response;
  response.content_type = content_type;
  response.body = WebAsset(name);
  response.headers = {{"Content-Security-Policy", kPagePolicy}, {"Cache-Control", "no-cache"}};
  return response;
}

HttpResponse Service::Artifact(const HttpRequest& request, const std::string& name) {
  const auto artifact = store_.FindArtifact(request.caller.owner, name);
  if (!artifact) return ProblemForStatus(404);
  const std::string tag = "\"" + name.substr(0, 64) + "\"";
  HttpResponse response;
  response.headers = {
      {"ETag", tag},
      {"Cache-Control", request.caller.owner.empty() ? "public, max-age=31536000, immutable"
                                                     : "private, max-age=31536000, immutable"},
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

HttpResponse Service::GetModel(const Caller& caller, const std::string& id) {
  const auto model = store_.FindModel(caller.owner, id);
  return model ? JsonResponse(200, ModelJson(*model)) : ProblemForStatus(404);
}

HttpResponse Service::ListModels(const HttpRequest& request) {
  const auto page = ParsePageRequest(request.query, kModelIdDigits);
  if (!page) return ProblemForError(page.error());
  Json models = Json::array();
  for (const ListedModel& model :
       store_.ListModels(request.caller.owner, page.value().after, page.value().limit + 1))
    models.push_back({{"id", model.id},
                      {"name", model.name},
                      {"bytes", model.bytes},
                      {"created", TimeJson(model.created)},
                      {"links", {{"self", "/v1/models/" + model.id}}}});
  return JsonResponse(200, PageJson("/v1/models", "models", page.value(), std::move(models)));
}

HttpResponse Service::RemoveModel(const Caller& caller, const std::string& id) {
  const auto removed = store_.RemoveModel(caller.owner, id);
  if (!removed) return ProblemForError({removed.error().code, "the removal cannot be stored"});
  switch (removed.value()) {
    case Removal::kNotThere:
      break;
    case Removal::kNeeded:
      return Problem(409, "in-use", "The model is in use",
                     "A job that waits or runs needs it. Cancel the job, or wait for its end.");
    case Removal::kRemoved: {
      HttpResponse response;
      response.status = 204;
      return response;
    }
  }
  return ProblemForStatus(404);
}

HttpResponse Service::GetAnswer(const Caller& caller, const std::string& key) {
  auto text = store_.FindAnswer(caller.owner, key);
  return text ? JsonTextResponse(200, std::move(*text)) : ProblemForStatus(404);
}

// ---- Jobs ----

std::optional<JobView> Service::FindJob(const Caller& caller, const std::string& id) {
  auto view = jobs_.Find(id);
  if (view && view->job.owner != caller.owner && !caller.admin) return std::nullopt;
  return view;
}

HttpResponse Service::GetJob(const Caller& caller, const std::string& id) {
  const auto view = FindJob(caller, id);
  if (!view) return ProblemForStatus(404);
  return SetResponseJob(JsonResponse(200, JobJson(*view, store_)), id);
}

HttpResponse Service::ListJobs(const HttpRequest& request) {
  const auto page = ParsePageRequest(request.query, kJobIdDigits);
  if (!page) return ProblemForError(page.error());
  const auto ids = jobs_.List(request.caller.owner, page.value().after, page.value().limit + 1);
  if (!ids)
    return ProblemForError(
        {ErrorCode::kBadUsage, "after must name one of your jobs that the service still remembers"});
  Json jobs = Json::array();
  for (const std::string& id : *ids)
    if (const auto view = jobs_.Find(id)) jobs.push_back(ListedJobJson(*view));
  return JsonResponse(200, PageJson("/v1/jobs", "jobs", page.value(), std::move(jobs)));
}

HttpResponse Service::CancelJob(const Caller& caller, const std::string& id) {
  if (!FindJob(caller, id)) return ProblemForStatus(404);
  auto cancelled = jobs_.Cancel(id);
  if (!cancelled) return ProblemForError({cancelled.error().code, "the cancellation cannot be stored"});
  if (!cancelled.value()) return ProblemForStatus(404);
  const JobView& view = *cancelled.value();
  return SetResponseJob(
      view.job.Ended() ? JsonResponse(200, JobJson(view, store_)) : AcceptedResponse(view, store_), id);
}

HttpResponse Service::JobEvents(const Caller& caller, const std::string& id) {
  if (!FindJob(caller, id)) return ProblemForStatus(404);
  auto place = std::make_shared<ScopedSlot>(*listeners_, limits_.listeners);
  if (!place->held()) return Busy("Too many clients follow events; poll the job instead.");
  HttpResponse response = EventsResponse(jobs_, store_, id);
  // The counter must exist as long as the stream, which may outlive the service.
  response.stream = [place, count = listeners_, next = std::move(response.stream)] { return next(); };
  return SetResponseJob(std::move(response), id);
}

HttpResponse Service::Submit(const HttpRequest& request, JobKind kind) {
  const Clock::time_point arrived = Clock::now();
  auto parsed = ParseSubmission(request, kind, limits_.max_samples);
  if (!parsed) return ProblemForError(parsed.error());
  const Submission& submission = parsed.value();
  NewJob job;
  job.retry_key = request.Header("idempotency-key");
  if (!IsRetryKey(job.retry_key))
    return ProblemForError(
        {ErrorCode::kBadUsage, "Idempotency-Key must be at most 255 printable ASCII characters"});

  // Answer a repeated question without a job.
  const std::string& owner = request.caller.owner;
  auto known = KnownAnswer(owner, submission);
  if (looked_up) looked_up(kind, known.has_value());
  if (known && job.retry_key.empty()) return StoredAnswerResponse(kind, submission.model_id, *known, arrived);
  if (!known && submission.file == nullptr && !store_.FindModel(owner, submission.model_id))
    return Problem(404, "not-found", "Not found", "There is no model " + submission.model_id + ".");

  // Store everything that the job needs before the job is submitted.
  job.kind = kind;
  job.owner = owner;
  job.question = submission.question;
  job.request = JobRequestJson(submission);
  job.request["request_id"] = request.id;
  if (!request.trace_id.empty()) job.request["trace_id"] = request.trace_id;
  job.body = submission.body;
  job.needs = {ModelItem(owner, submission.model_id)};
  if (known)
    job.result = kind == JobKind::kModel ? ModelItem(owner, submission.model_id)
                                         : AnswerItem(owner, submission.question);
  std::vector<StoredFile> uploads;
  if (!known) {
    if (auto kept = StoreUploads(request.caller, submission, job, uploads); !kept)
      return ProblemForError(
          {kept.error().code, "the upload cannot be stored: the disk or the store is full"});
  }
  auto submitted = jobs_.Submit(job);
  uploads.clear();
  if (!submitted) return ProblemForError({submitted.error().code, "the job cannot be stored"});
  switch (submitted.value().outcome) {
    case SubmitOutcome::kKeyReused:
      return Problem(422, "key-reused", "The Idempotency-Key belongs to another request",
                     "Send a new key with a new request.");
    case SubmitOutcome::kQueueFull:
      return Busy("Too many jobs are waiting; try again soon.");
    case SubmitOutcome::kShareFull:
      return Busy("Too many of your jobs are waiting; try again when some of them are done.");
    case SubmitOutcome::kAccepted:
    case SubmitOutcome::kSame:
      break;
  }
  return SetResponseJob(WaitAndAnswer(request, submitted.value(), arrived), submitted.value().job.id);
}

std::optional<std::string> Service::KnownAnswer(const std::string& owner, const Submission& submission) {
  if (submission.kind != JobKind::kModel) return store_.FindAnswer(owner, submission.question);
  const auto model = store_.FindModel(owner, submission.model_id);
  if (!model) return std::nullopt;
  return JsonText(ModelJson(*model)) + "\n";
}

Result<void> Service::StoreUploads(const Caller& caller, const Submission& submission, NewJob& job,
                                   std::vector<StoredFile>& kept) {
  std::uint64_t bytes = 0;
  for (const BodyPart* part : {submission.file, submission.mesh}) bytes += part != nullptr ? part->bytes : 0;
  if (auto room = store_.MakeRoom(bytes); !room) return room;
  if (auto room = store_.MakeRoomFor(caller.owner, caller.quota_mb << 20, bytes); !room) return room;
  for (const auto& [role, part] : {std::pair{"file", submission.file}, {"mesh", submission.mesh}}) {
    if (part == nullptr) continue;
    auto file = store_.AddFile(part->path, part->sha256);
    if (!file) return file.error();
    job.files.push_back({role, file.value().sha256, file.value().bytes});
    kept.push_back(std::move(file).value());
  }
  return {};
}

HttpResponse Service::WaitAndAnswer(const HttpRequest& request, const Submitted& submitted,
                                    Clock::time_point arrived) {
  const ScopedSlot place(waiters_, limits_.waiters);
  const double wanted =
      WaitSeconds(request.Header("prefer"), kUsualWaitSeconds, limits_.timeout_s + kEndSeconds);
  const auto view = jobs_.WaitForEnd(submitted.job.id, place.held() ? wanted : 0);
  if (!view) return ProblemForStatus(404);
  switch (view->job.state) {
    case JobState::kQueued:
    case JobState::kRunning:
      return AcceptedResponse(*view, store_);
    case JobState::kFailed:
      return ProblemResponse(view->job.problem);
    case JobState::kCancelled:
      return Problem(409, "cancelled", "The job was cancelled",
                     "A client cancelled the job. Send the request again if you need the result.");
    case JobState::kDone:
      break;
  }
  auto text = AnswerText(view->job, store_);
  // The store has deleted the answer before it could be sent. Send the job instead, which shows this.
  if (!text) return JsonResponse(200, JobJson(*view, store_));
  // The answer existed already, or the work was done for an earlier request.
  if (view->job.attempts == 0 || submitted.outcome == SubmitOutcome::kSame)
    return StoredAnswerResponse(view->job.kind, view->job.ModelId(), *text, arrived);
  const bool created = view->job.kind == JobKind::kModel && submitted.outcome == SubmitOutcome::kAccepted &&
                       view->job.attempts > 0;
  return Answer(created ? 201 : 200, view->job.kind, view->job.ModelId(), std::move(*text));
}

}  // namespace facetless
