// The addresses of the service.
#pragma once

#include <string>

namespace facetless {

enum class RouteKind { kNone, kPage, kHealth, kSubmit, kModel, kAnswer, kArtifact, kJob, kJobEvents };

struct Route {
  RouteKind kind = RouteKind::kNone;
  std::string argument;      // kPage: the file in server/web; kSubmit: the job's kind; else the id or name
  std::string content_type;  // kPage
  std::string methods = "GET, HEAD";

  bool Allows(const std::string& method) const;
};

// kNone where there is nothing.
Route FindRoute(const std::string& path);

}  // namespace facetless
