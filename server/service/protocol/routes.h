// The addresses of the service.
#pragma once

#include <string>
#include <vector>

namespace facetless {

enum class RouteKind {
  kNone,
  kPage,
  kHealth,
  kReady,
  kMetrics,
  kSubmit,
  kModel,
  kAnswer,
  kArtifact,
  kJobs,
  kJob,
  kJobEvents
};

struct Route {
  RouteKind kind = RouteKind::kNone;
  std::string argument;      // kPage: the file in server/web; kSubmit: the job's kind; else the id or name
  std::string content_type;  // kPage
  std::string methods = "GET, HEAD";
  std::string pattern = "none";  // as in openapi.json: "/v1/models/{id}"

  bool Allows(const std::string& method) const;
};

// kNone where there is nothing.
Route FindRoute(const std::string& path);

// Every route, `argument` empty where it is a part of the path.
const std::vector<Route>& AllRoutes();

}  // namespace facetless
