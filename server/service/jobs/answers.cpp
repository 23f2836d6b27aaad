#include "server/service/jobs/answers.h"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <utility>

#include "server/base/files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The interval of heartbeats, because proxies close connections that are silent for about half a minute.
constexpr double kHeartbeatSeconds = 10;

std::string Event(const char* name, const Json& data) {
  return std::string("event: ") + name + "\ndata: " + JsonText(data, -1) + "\n\n";
}

// The events of one listener; each call returns the next ones.
class EventSource {
 public:
  EventSource(Jobs& jobs, Store& store, std::string id) : jobs_(jobs), store_(store), id_(std::move(id)) {}

  std::optional<std::string> Next() {
    if (ended_) return std::nullopt;
    // Send the current state first, and then every change.
    auto view = first_ ? jobs_.Find(id_) : jobs_.WaitForChange(id_, version_, kHeartbeatSeconds);
    if (!view) return std::nullopt;
    std::string text;
    if (view->job.attempts != attempts_) messages_ = 0;
    attempts_ = view->job.attempts;
    for (; messages_ < view->messages.size(); ++messages_)
      text += Event("message", {{"text", view->messages[messages_]}});
    const Json progress = {{"stage", view->stage}, {"fraction", view->fraction}};
    if (first_ || progress != progress_) text += Event("progress", progress);
    progress_ = progress;
    version_ = view->version;
    first_ = false;
    if (view->job.Ended()) {
      ended_ = true;
      return text + Event("end", JobJson(*view, store_));
    }
    // A service that stops keeps the queued job for its next start, but ends the stream.
    if (jobs_.stopping() && text.empty() && view->job.state == JobState::kQueued) return std::nullopt;
    return text.empty() ? ": heartbeat\n\n" : text;
  }

 private:
  Jobs& jobs_;
  Store& store_;
  const std::string id_;
  bool first_ = true, ended_ = false;
  std::uint64_t version_ = 0;
  int attempts_ = 0;
  std::size_t messages_ = 0;
  Json progress_;
};

}  // namespace

Json TimeJson(double seconds) {
  if (!(seconds > 0)) return nullptr;
  const auto whole = static_cast<std::time_t>(seconds);
  std::tm utc = {};
  gmtime_r(&whole, &utc);
  char text[32];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  const int milliseconds = static_cast<int>((seconds - std::floor(seconds)) * 1000);
  std::snprintf(text + length, sizeof text - length, ".%03dZ", milliseconds);
  return text;
}

HttpResponse JsonTextResponse(int status, std::string text) {
  HttpResponse response;
  response.status = status;
  response.content_type = "application/json";
  response.body = std::move(text);
  response.headers = {{"Cache-Control", "no-store"}};
  return response;
}

HttpResponse JsonResponse(int status, const Json& json) {
  return JsonTextResponse(status, JsonText(json) + "\n");
}

Json ModelJson(const StoredModel& model) {
  return {{"id", model.id},
          {"name", model.name},
          {"bytes", model.bytes},
          {"model", model.report},
          {"links", {{"self", "/v1/models/" + model.id}}}};
}

std::optional<std::string> AnswerText(const Job& job, Store& store) {
  if (job.kind != JobKind::kModel) return store.FindAnswer(job.owner, KeyOfItem(job.result));
  const auto model = store.FindModel(job.owner, job.ModelId());
  if (!model) return std::nullopt;
  return JsonText(ModelJson(*model)) + "\n";
}

Json ListedJobJson(const JobView& view) {
  const Job& job = view.job;
  const std::string self = "/v1/jobs/" + job.id;
  Json json = {{"id", job.id},
               {"kind", JobKindName(job.kind)},
               {"state", JobStateName(job.state)},
               {"stage", view.stage},
               {"fraction", view.fraction},
               {"created", TimeJson(job.created)},
               {"started", TimeJson(job.started)},
               {"finished", TimeJson(job.finished)},
               {"attempts", job.attempts},
               {"links", {{"self", self}, {"events", self + "/events"}}}};
  if (job.state == JobState::kFailed) json["problem"] = job.problem;
  return json;
}

Json JobJson(const JobView& view, Store& store) {
  const Job& job = view.job;
  Json json = ListedJobJson(view);
  if (job.state != JobState::kDone) return json;
  json["result"] = nullptr;
  const auto text = AnswerText(job, store);
  if (!text) return json;
  json["result"] = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  json["links"]["result"] =
      job.kind == JobKind::kModel ? "/v1/models/" + job.ModelId() : "/v1/answers/" + KeyOfItem(job.result);
  return json;
}

HttpResponse AcceptedResponse(const JobView& view, Store& store) {
  HttpResponse response = JsonResponse(202, JobJson(view, store));
  response.headers.emplace_back("Location", "/v1/jobs/" + view.job.id);
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

HttpResponse EventsResponse(Jobs& jobs, Store& store, const std::string& id) {
  HttpResponse response;
  response.content_type = "text/event-stream";
  response.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
  auto source = std::make_shared<EventSource>(jobs, store, id);
  response.stream = [source] { return source->Next(); };
  return response;
}

}  // namespace facetless
