// The addresses of the service.
#pragma once

#include <string>
#include <vector>

#include "server/service/jobs/job_kinds.h"

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
  std::string argument;      // kPage: the file in server/web; else the id or name
  std::string content_type;  // kPage
  std::string methods = "GET, HEAD";
  std::string pattern = "none";     // as in openapi.json: "/v1/models/{id}"
  JobKind job = JobKind::kUnknown;  // kSubmit

  bool Allows(const std::string& method) const;
};

// kNone where there is nothing.
Route FindRoute(const std::string& path);

// Every route, `argument` empty where it is a part of the path.
const std::vector<Route>& AllRoutes();

}  // namespace facetless
