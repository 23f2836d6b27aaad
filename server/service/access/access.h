// Who may do what: one decision per request, before its body is read.
//
//  1. A key that is given (Authorization: Bearer …) must be a good one. Without one a caller is "", if
//     callers without a key are let in at all. The page, its files, /healthz and /readyz are for everybody;
//     /metrics is too where it has a listener of its own, and elsewhere for keys with the scope admin.
//  2. What a key made is seen by that key only; for everybody else it is not there (404).
//  3. Each decision about a key, or the lack of one, is one line for the log, with the key's id and never the
//     key.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "server/service/access/keys.h"
#include "server/service/jobs/routes.h"
#include "server/service/protocol/message.h"

namespace facetless {

class AccessControl {
 public:
  // `keys` must outlive it.
  AccessControl(KeyStore& keys, bool anonymous) : keys_(keys), anonymous_(anonymous) {}

  // Sets request.caller; 401, 403 or 429 if the request must not go on.
  std::optional<HttpResponse> Decide(HttpRequest& request, const Route& route);

  // Called with each decision; may be empty. To be set before the first one.
  std::function<void(const std::string&, const HttpRequest&)> audit;

 private:
  struct Bucket {
    double tokens = 0;
    std::chrono::steady_clock::time_point filled;
  };
  std::optional<HttpResponse> Judge(HttpRequest& request, const Route& route, std::string& reason);
  bool TakeToken(const AccessKey& key);

  KeyStore& keys_;
  const bool anonymous_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace facetless
