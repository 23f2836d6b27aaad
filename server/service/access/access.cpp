#include "server/service/access/access.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "server/service/protocol/problem.h"

namespace facetless {
namespace {

constexpr double kMinuteSeconds = 60;

// The text after "Bearer ", in any case; nothing if there is no Authorization header.
std::optional<std::string> BearerText(const HttpRequest& request) {
  const std::string header = request.Header("authorization");
  if (header.empty()) return std::nullopt;
  constexpr std::size_t kLength = 7;
  std::string scheme = header.substr(0, kLength);
  for (char& c : scheme) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return scheme == "bearer " ? header.substr(kLength) : "";
}

HttpResponse Unauthorized(const std::string& detail) {
  HttpResponse response = Problem(401, "unauthorized", "A key is needed", detail);
  response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"facetless\"");
  return response;
}

}  // namespace

std::optional<HttpResponse> AccessControl::Decide(HttpRequest& request, const Route& route) {
  if (route.kind == RouteKind::kPage || route.kind == RouteKind::kHealth || route.kind == RouteKind::kReady ||
      (route.kind == RouteKind::kMetrics && request.operations))
    return std::nullopt;
  std::string reason;
  auto refusal = Judge(request, route, reason);
  // If callers without keys are allowed, a request without a key is not a decision to record.
  if (audit && (!anonymous_ || !request.Header("authorization").empty())) {
    const std::string who = request.caller.owner.empty() ? "none" : request.caller.owner;
    audit("key=" + who + " " + request.method + " " + request.path +
              (refusal ? " denied: " + reason : " allowed"),
          request);
  }
  return refusal;
}

std::optional<HttpResponse> AccessControl::Judge(HttpRequest& request, const Route& route,
                                                 std::string& reason) {
  const auto text = BearerText(request);
  if (!text) {
    if (anonymous_) return std::nullopt;
    reason = "no key";
    return Unauthorized("Send it as Authorization: Bearer KEY.");
  }
  const auto key = keys_.Verify(*text);
  if (!key) {
    reason = "no such key, or a revoked one";
    return Unauthorized("There is no such key, or it was revoked.");
  }
  Caller& caller = request.caller;
  caller.owner = key->id;
  caller.read = key->read;
  caller.submit = key->submit;
  caller.admin = key->admin;
  caller.quota_mb = static_cast<std::uint64_t>(std::max<std::int64_t>(key->quota_mb, 0));
  const bool job = route.kind == RouteKind::kJob || route.kind == RouteKind::kJobEvents;
  const bool reads = request.method == "GET" || request.method == "HEAD";
  const bool allowed = route.kind == RouteKind::kMetrics
                           ? caller.admin
                           : (reads ? caller.read : caller.submit) || (caller.admin && job);
  if (!allowed) {
    reason = "its scopes are " + ScopesText(*key);
    return Problem(403, "forbidden", "This key does not allow the request",
                   "Its scopes are " + ScopesText(*key) + ".");
  }
  if (!TakeToken(*key)) {
    reason = "more than " + std::to_string(key->rate) + " requests a minute";
    HttpResponse response = Problem(429, "rate-limited", "Too many requests",
                                    "This key has " + std::to_string(key->rate) + " a minute.");
    response.headers.emplace_back("Retry-After", std::to_string(60 / key->rate + 1));
    return response;
  }
  return std::nullopt;
}

bool AccessControl::TakeToken(const AccessKey& key) {
  if (key.rate <= 0) return true;
  const auto most = static_cast<double>(key.rate);
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  // The bucket holds the requests of one minute and is refilled continuously.
  auto [found, fresh] = buckets_.try_emplace(key.id, Bucket{most, now});
  Bucket& bucket = found->second;
  const double seconds = std::chrono::duration<double>(now - bucket.filled).count();
  bucket.tokens = std::min(most, bucket.tokens + seconds * most / kMinuteSeconds);
  bucket.filled = now;
  if (bucket.tokens < 1) return false;
  bucket.tokens -= 1;
  return true;
}

}  // namespace facetless
