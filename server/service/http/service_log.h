// The service's log: a line for each thing that happened, on standard error, for a person or as JSON for a
// program.
//
//  1. A line is one line whatever is in it, and holds no key: what looks like one is cut after its id.
//  2. Both forms hold the ids that belong to it (request_id, trace_id, key_id, job_id): what a caller
//     reports, a response's X-Request-Id or a problem's job_id, is found here.
//  3. docs/api.md, "Log", lists the fields: changing one breaks somebody's search.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "server/service/http/http_server.h"
#include "server/service/jobs/job_store.h"

namespace facetless {

struct LogEntry {
  std::string level = "info";  // info or error
  std::string event;           // service, request, audit or job
  std::string text;            // for people
  nlohmann::json fields = nlohmann::json::object();
};

LogEntry RequestEntry(const ServedRequest& request);
LogEntry AuditEntry(const std::string& decision, const HttpRequest& request);
LogEntry JobEntry(const Job& ended, double seconds);  // seconds: observer.h

// The line of an entry, without its end. `time`: seconds since 1970.
std::string LogLine(const LogEntry& entry, double time, bool json);

// The text with "***" in the place of secrets of keys (keys.h), and "?" for control characters.
std::string WithoutSecrets(const std::string& text);

// Writes to standard error, from any thread.
class ServiceLog {
 public:
  // `form`: json, text, or auto: text on a terminal, else json.
  explicit ServiceLog(const std::string& form);
  void Write(const LogEntry& entry);

 private:
  const bool json_;
};

}  // namespace facetless
