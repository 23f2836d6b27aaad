#include "server/service/routes.h"

#include <string_view>

namespace facetless {

Route FindRoute(const std::string& path) {
  static const struct {
    const char* path;
    Route route;
  } kFixed[] = {
      {"/", {RouteKind::kPage, "index.html", "text/html; charset=utf-8", false}},
      {"/style.css", {RouteKind::kPage, "style.css", "text/css; charset=utf-8", false}},
      {"/app.js", {RouteKind::kPage, "app.js", "text/javascript; charset=utf-8", false}},
      {"/viewer.js", {RouteKind::kPage, "viewer.js", "text/javascript; charset=utf-8", false}},
      {"/favicon.svg", {RouteKind::kPage, "favicon.svg", "image/svg+xml", false}},
      {"/healthz", {RouteKind::kHealth, "", "", false}},
      {"/v1/models", {RouteKind::kModels, "", "", true}},
      {"/v1/render", {RouteKind::kRender, "", "", true}},
      {"/v1/compare", {RouteKind::kCompare, "", "", true}},
  };
  for (const auto& fixed : kFixed) {
    if (path == fixed.path) return fixed.route;
  }
  static const struct {
    std::string_view prefix;
    RouteKind kind;
  } kPrefixes[] = {{"/v1/models/", RouteKind::kModel}, {"/v1/artifacts/", RouteKind::kArtifact}};
  for (const auto& [prefix, kind] : kPrefixes) {
    if (path.starts_with(prefix) && path.size() > prefix.size())
      return {kind, path.substr(prefix.size()), "", false};
  }
  return {};
}

}  // namespace facetless
