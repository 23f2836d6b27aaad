#include "server/service/routes.h"

#include <string_view>

namespace facetless {

bool Route::Allows(const std::string& method) const {
  for (std::size_t begin = 0; begin < methods.size();) {
    const std::size_t end = std::min(methods.find(", ", begin), methods.size());
    if (methods.compare(begin, end - begin, method) == 0) return true;
    begin = end + 2;
  }
  return false;
}

Route FindRoute(const std::string& path) {
  static const struct {
    const char* path;
    Route route;
  } kFixed[] = {
      {"/", {RouteKind::kPage, "index.html", "text/html; charset=utf-8"}},
      {"/style.css", {RouteKind::kPage, "style.css", "text/css; charset=utf-8"}},
      {"/app.js", {RouteKind::kPage, "app.js", "text/javascript; charset=utf-8"}},
      {"/viewer.js", {RouteKind::kPage, "viewer.js", "text/javascript; charset=utf-8"}},
      {"/favicon.svg", {RouteKind::kPage, "favicon.svg", "image/svg+xml"}},
      {"/healthz", {RouteKind::kHealth, "", ""}},
      {"/v1/models", {RouteKind::kSubmit, "model", "", "POST"}},
      {"/v1/renders", {RouteKind::kSubmit, "render", "", "POST"}},
      {"/v1/comparisons", {RouteKind::kSubmit, "comparison", "", "POST"}},
      {"/v1/trades", {RouteKind::kSubmit, "trade", "", "POST"}},
      // Their names before there were jobs.
      {"/v1/render", {RouteKind::kSubmit, "render", "", "POST"}},
      {"/v1/compare", {RouteKind::kSubmit, "comparison", "", "POST"}},
  };
  for (const auto& fixed : kFixed) {
    if (path == fixed.path) return fixed.route;
  }
  static const struct {
    std::string_view prefix, suffix;
    RouteKind kind;
    const char* methods;
  } kPatterns[] = {{"/v1/models/", "", RouteKind::kModel, "GET, HEAD"},
                   {"/v1/answers/", "", RouteKind::kAnswer, "GET, HEAD"},
                   {"/v1/artifacts/", "", RouteKind::kArtifact, "GET, HEAD"},
                   {"/v1/jobs/", "/events", RouteKind::kJobEvents, "GET, HEAD"},
                   {"/v1/jobs/", "", RouteKind::kJob, "GET, HEAD, DELETE"}};
  for (const auto& [prefix, suffix, kind, methods] : kPatterns) {
    if (!path.starts_with(prefix) || !path.ends_with(suffix) || path.size() <= prefix.size() + suffix.size())
      continue;
    return {kind, path.substr(prefix.size(), path.size() - prefix.size() - suffix.size()), "", methods};
  }
  return {};
}

}  // namespace facetless
