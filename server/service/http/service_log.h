// The log of the service: one line for each event, on standard error, as text or as JSON.
//
//  1. Every entry is a single line, whatever it contains, and contains no key: a text that looks like a key
//     is cut off after its id.
//  2. Both forms contain the ids of the event (request_id, trace_id, key_id, job_id). The ids that a caller
//     can report, X-Request-Id of a response or job_id of a problem, can therefore be found in the log.
//  3. docs/api.md, "Log", lists the fields. Operators search for them, so they must not change.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/service/http/http_server.h"
#include "server/service/jobs/job_store.h"

namespace facetless {

struct LogEntry {
  std::string level = "info";  // info or error
  std::string event;           // service, request, audit or job
  std::string text;            // readable text
  nlohmann::json fields = nlohmann::json::object();
};

LogEntry RequestEntry(const ServedRequest& request);
LogEntry AuditEntry(const std::string& decision, const HttpRequest& request);
LogEntry JobEntry(const Job& ended, double seconds);  // seconds: as in Observer::job_ended

// The line of an entry, without the line end. `time`: seconds since 1970.
std::string LogLine(const LogEntry& entry, double time, bool json);

// The text with the secrets of keys (keys.h) replaced by "***", and control characters replaced by "?".
std::string WithoutSecrets(const std::string& text);

// Writes to standard error, from any thread.
class ServiceLog {
 public:
  // `form` is json, text or auto, which means text on a terminal and json otherwise.
  explicit ServiceLog(const std::string& form);
  void Write(const LogEntry& entry);

 private:
  const bool json_;
};

}  // namespace facetless
