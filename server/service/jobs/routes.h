// The routes of the service: its addresses and their methods.
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
  kJobEvents,
  kMethods
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

// The route of a path; kNone if there is nothing at the path.
Route FindRoute(const std::string& path);

// All routes. `argument` is empty if it is a part of the path.
const std::vector<Route>& AllRoutes();

}  // namespace facetless
