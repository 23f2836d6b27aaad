#include "server/service/jobs/routes.h"

#include <algorithm>
#include <optional>

namespace facetless {
namespace {

Route Page(const char* path, const char* file, const char* content_type) {
  return {RouteKind::kPage, file, content_type, "GET, HEAD", path};
}

// Models can be listed where they are posted.
Route Submit(const std::string& path, JobKind kind) {
  return {RouteKind::kSubmit, "", "", kind == JobKind::kModel ? "GET, HEAD, POST" : "POST", path, kind};
}

Route ReadRoute(RouteKind kind, const char* path, const char* methods = "GET, HEAD") {
  return {kind, "", "", methods, path};
}

// Returns the text of `path` that stands for the part of `pattern` in braces ("" without braces), or nothing
// if the path does not match.
std::optional<std::string> Match(const std::string& pattern, const std::string& path) {
  const std::size_t open = pattern.find('{');
  if (open == std::string::npos) return pattern == path ? std::optional<std::string>("") : std::nullopt;
  const std::string prefix = pattern.substr(0, open), suffix = pattern.substr(pattern.find('}') + 1);
  if (!path.starts_with(prefix) || !path.ends_with(suffix) || path.size() <= prefix.size() + suffix.size())
    return std::nullopt;
  return path.substr(prefix.size(), path.size() - prefix.size() - suffix.size());
}

}  // namespace

bool Route::Allows(const std::string& method) const {
  for (std::size_t begin = 0; begin < methods.size();) {
    const std::size_t end = std::min(methods.find(", ", begin), methods.size());
    if (methods.compare(begin, end - begin, method) == 0) return true;
    begin = end + 2;
  }
  return false;
}

const std::vector<Route>& AllRoutes() {
  static const std::vector<Route> kRoutes = [] {
    std::vector<Route> routes = {
        Page("/", "index.html", "text/html; charset=utf-8"),
        Page("/style.css", "style.css", "text/css; charset=utf-8"),
        // The page's modules.
        Page("/page/{name}", "", "text/javascript; charset=utf-8"),
        Page("/favicon.svg", "favicon.svg", "image/svg+xml"),
        Page("/openapi.json", "openapi.json", "application/json"),
        ReadRoute(RouteKind::kHealth, "/healthz"),
        ReadRoute(RouteKind::kReady, "/readyz"),
        ReadRoute(RouteKind::kMetrics, "/metrics"),
        ReadRoute(RouteKind::kMethods, "/v1/methods"),
        ReadRoute(RouteKind::kModel, "/v1/models/{id}", "GET, HEAD, DELETE"),
        ReadRoute(RouteKind::kAnswer, "/v1/answers/{id}"),
        ReadRoute(RouteKind::kArtifact, "/v1/artifacts/{name}"),
        ReadRoute(RouteKind::kJobs, "/v1/jobs"),
        // Before the next one, which would take it for an id.
        ReadRoute(RouteKind::kJobEvents, "/v1/jobs/{id}/events"),
        ReadRoute(RouteKind::kJob, "/v1/jobs/{id}", "GET, HEAD, DELETE"),
    };
    for (const JobKindRow& kind : JobKinds())
      for (const std::string& address : kind.addresses) routes.push_back(Submit(address, kind.kind));
    return routes;
  }();
  return kRoutes;
}

Route FindRoute(const std::string& path) {
  for (const Route& known : AllRoutes()) {
    const auto argument = Match(known.pattern, path);
    if (!argument) continue;
    Route route = known;
    if (!argument->empty()) route.argument = *argument;
    return route;
  }
  return {};
}

}  // namespace facetless
