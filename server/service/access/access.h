// Access control: one decision for each request, before its body is read.
//
//  1. If a request has a key (Authorization: Bearer …), the key must be valid. A caller without a key is "",
//     if callers without keys are allowed at all. The page, its files, /healthz and /readyz need no key.
//     /metrics needs none if it has a separate listener; otherwise it needs a key with the scope admin.
//  2. A caller sees only what was made with the same key. For all other callers it does not exist (404).
//  3. Each decision about a key, or about a missing key, is one line in the log. The line has the id of the
//     key, but never the key.
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
  // `keys` must outlive this object.
  AccessControl(KeyStore& keys, bool anonymous) : keys_(keys), anonymous_(anonymous) {}

  // Sets request.caller. Returns a response with status 401, 403 or 429 if the request is refused.
  std::optional<HttpResponse> Decide(HttpRequest& request, const Route& route);

  // Called with each decision; may be empty. It must be set before the first decision.
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
