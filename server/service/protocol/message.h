// HTTP requests and responses as plain data: what passes between the transport (http_server.h) and the
// service (service.h).
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/temp_dir.h"

namespace facetless {

// One part of a multipart body; a body of another type is one part without a name.
struct BodyPart {
  std::string name, file_name, content_type;
  std::string text;    // the content of small parts
  std::string path;    // of a part kept in a file: where; else empty
  std::string sha256;  // of a part kept in a file
  std::uint64_t bytes = 0;
};

// Who sent a request, as access.h found.
struct Caller {
  std::string owner;  // the id of a key; "" for a caller without one
  bool read = true, submit = true, admin = false;
  std::uint64_t quota_mb = 0;  // of what is kept for the owner; 0: none
};

struct HttpRequest {
  std::string method, path;                    // path: decoded, without the query
  std::map<std::string, std::string> headers;  // names in lower case; of repeated ones the first
  std::map<std::string, std::string> query;
  std::vector<BodyPart> parts;
  TempDir uploads;  // holds the parts' files
  Caller caller;
  std::string id;           // in X-Request-Id of the response, and in the log
  std::string trace_id;     // of its traceparent (trace_context.h); "" without a sound one
  bool admitted = false;    // Service::Check has let it pass
  bool operations = false;  // came in where health and metrics are served, and nothing else

  std::string Header(const std::string& lower_case_name) const {
    const auto found = headers.find(lower_case_name);
    return found == headers.end() ? "" : found->second;
  }
};

struct HttpResponse {
  int status = 200;
  std::string content_type;
  std::string body;
  std::string file_path;  // if not empty, the body is this file's content
  // If not empty, the body is what this returns, one piece after the other, until it returns nothing. It may
  // take seconds to find the next piece.
  std::function<std::optional<std::string>()> stream;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string job;  // the id of the job that this is about, for the log; "" if it is about none
};

}  // namespace facetless
