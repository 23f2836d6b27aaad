#include "server/service/http/service_log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "server/base/files.h"
#include "server/service/jobs/answers.h"
#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

constexpr const char* kIds[] = {"request_id", "trace_id", "key_id", "job_id"};

// Adds a field unless its value is empty.
void AddText(Json& fields, const char* name, const std::string& value) {
  if (!value.empty()) fields[name] = value;
}

std::string Milliseconds(double ms) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f ms", ms);
  return text;
}

// Rounds to microseconds.
double Rounded(double ms) {
  return std::round(ms * 1e3) / 1e3;
}

bool IsKeyText(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F') || c == '_';
}

}  // namespace

std::string WithoutSecrets(const std::string& text) {
  std::string cut;
  for (const char c : text) cut += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  const std::string prefix = "facetless_";
  for (std::size_t at = cut.find(prefix); at != std::string::npos; at = cut.find(prefix, at + 1)) {
    // A key is facetless_<id>_<secret>. Remove everything after the id, however long it is.
    const std::size_t secret = cut.find('_', at + prefix.size());
    std::size_t end = at + prefix.size();
    while (end < cut.size() && IsKeyText(cut[end])) ++end;
    if (secret < end) cut.replace(secret + 1, end - secret - 1, "***");
  }
  return cut;
}

LogEntry RequestEntry(const ServedRequest& request) {
  LogEntry entry;
  entry.event = "request";
  entry.text = request.method + " " + request.path + " " + std::to_string(request.status) + " " +
               Milliseconds(request.ms);
  entry.fields = {{"method", request.method},
                  {"path", request.path},
                  {"status", request.status},
                  {"ms", Rounded(request.ms)}};
  AddText(entry.fields, "request_id", request.id);
  AddText(entry.fields, "trace_id", request.trace_id);
  AddText(entry.fields, "key_id", request.key);
  AddText(entry.fields, "job_id", request.job);
  return entry;
}

LogEntry AuditEntry(const std::string& decision, const HttpRequest& request) {
  LogEntry entry;
  entry.event = "audit";
  entry.text = "audit " + decision;
  AddText(entry.fields, "request_id", request.id);
  AddText(entry.fields, "trace_id", request.trace_id);
  AddText(entry.fields, "key_id", request.caller.owner);
  return entry;
}

LogEntry JobEntry(const Job& ended, double seconds) {
  constexpr double kSecondMs = 1e3;
  const double ms = seconds * kSecondMs;
  LogEntry entry;
  entry.event = "job";
  entry.text = KindText(ended) + " " + JobStateName(ended.state) + " " + Milliseconds(ms);
  entry.fields = {{"kind", KindText(ended)},
                  {"state", JobStateName(ended.state)},
                  {"ms", Rounded(ms)},
                  {"attempts", ended.attempts}};
  if (ended.problem.is_object()) {
    const std::string type = ended.problem.value("type", "");
    AddText(entry.fields, "problem", type);
    entry.text += " " + type;
  }
  if (ended.request.is_object()) {
    AddText(entry.fields, "request_id", ended.request.value("request_id", ""));
    AddText(entry.fields, "trace_id", ended.request.value("trace_id", ""));
  }
  AddText(entry.fields, "key_id", ended.owner);
  AddText(entry.fields, "job_id", ended.id);
  return entry;
}

std::string LogLine(const LogEntry& entry, double time, bool json) {
  Json fields = entry.fields;
  for (Json& field : fields) {
    if (field.is_string()) field = WithoutSecrets(field.get<std::string>());
  }
  const std::string text = WithoutSecrets(entry.text), when = TimeJson(time).get<std::string>();
  if (json) {
    fields["time"] = when;
    fields["level"] = entry.level;
    fields["event"] = entry.event;
    fields["message"] = text;
    return JsonText(fields, -1);
  }
  std::string line = when + " " + entry.level + " " + text;
  for (const char* id : kIds) {
    if (fields.contains(id)) line += std::string(" ") + id + "=" + fields[id].get<std::string>();
  }
  return line;
}

ServiceLog::ServiceLog(const std::string& form)
    : json_(form == "json" || (form == "auto" && isatty(STDERR_FILENO) == 0)) {
  // The library writes complete lines from any thread. The format of the lines is decided here.
  auto log = spdlog::get("facetless");
  if (!log) log = spdlog::stderr_logger_mt("facetless");
  log->set_pattern("%v");
}

void ServiceLog::Write(const LogEntry& entry) {
  spdlog::get("facetless")->info("{}", LogLine(entry, WallClock(), json_));
}

}  // namespace facetless
