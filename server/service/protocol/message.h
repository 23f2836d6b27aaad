// HTTP requests and responses as plain data, which the transport (http_server.h) and the service (service.h)
// exchange.
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

// One part of a multipart body. A body of another type is one part without a name.
struct BodyPart {
  std::string name, file_name, content_type;
  std::string text;    // the content of small parts
  std::string path;    // path of a part that is stored in a file; otherwise empty
  std::string sha256;  // digest of a part that is stored in a file
  std::uint64_t bytes = 0;
};

// The sender of a request, as determined by access.h.
struct Caller {
  std::string owner;  // the id of a key; "" for a caller without one
  bool read = true, submit = true, admin = false;
  std::uint64_t quota_mb = 0;  // limit of what the store keeps for the owner; 0: no limit
};

struct HttpRequest {
  std::string method, path;                    // path: decoded, without the query
  std::map<std::string, std::string> headers;  // names in lower case; for a repeated header, the first value
  std::map<std::string, std::string> query;
  std::vector<BodyPart> parts;
  TempDir uploads;  // contains the files of the parts
  Caller caller;
  std::string id;           // appears in X-Request-Id of the response, and in the log
  std::string trace_id;     // from the traceparent header (trace_context.h); "" without a valid one
  bool admitted = false;    // Service::Check has accepted the request
  bool operations = false;  // the request came through the listener for health and metrics

  std::string Header(const std::string& lower_case_name) const {
    const auto found = headers.find(lower_case_name);
    return found == headers.end() ? "" : found->second;
  }
};

struct HttpResponse {
  int status = 200;
  std::string content_type;
  std::string body;
  std::string file_path;  // if not empty, the body is the content of this file
  // If not empty, the body consists of the pieces that this function returns, until it returns nothing. The
  // next piece may take seconds.
  std::function<std::optional<std::string>()> stream;
  std::vector<std::pair<std::string, std::string>> headers;
  std::string job;  // id of the job to which the response refers, for the log; "" if there is none
};

}  // namespace facetless
