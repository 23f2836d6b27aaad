// The addresses of the service.
#pragma once

#include <string>

namespace facetless {

enum class RouteKind { kNone, kPage, kHealth, kModels, kModel, kRender, kCompare, kArtifact };

struct Route {
  RouteKind kind = RouteKind::kNone;
  std::string argument;      // kPage: the file in server/web; kModel: the id; kArtifact: the name
  std::string content_type;  // kPage
  bool post = false;         // POST only; else GET and HEAD
};

// kNone where there is nothing.
Route FindRoute(const std::string& path);

}  // namespace facetless
