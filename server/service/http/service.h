// The service without the transport: it maps requests to responses. docs/api.md is its contract with callers.
//
//     Service service(store, jobs, access, limits);
//     std::optional<HttpResponse> refused = service.Check(request);
//     const HttpResponse response = refused ? *refused : service.Handle(request);
//
//  1. Handle may be called from many threads. Work is done as a job (jobs.h). The job is in the job store
//     before it starts, and a request waits for its end only as long as the caller wants.
//  2. Check examines a request before its body is read. A request that fails there would also fail
//     afterwards.
//  3. A question that was answered before is answered by a look-up, however full the queue is.
//  4. access.h decides what a caller may see and do. For a caller, things of other owners do not exist.
//  5. Every error is a problem document (problem.h). No message contains the paths of the service's files.
//  6. If health and metrics have a separate listener (HttpRequest::operations), that listener serves nothing
//     else, and /metrics is not served elsewhere.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "server/service/access/access.h"
#include "server/service/http/metrics.h"
#include "server/service/jobs/jobs.h"
#include "server/service/jobs/submission.h"
#include "server/service/protocol/hosts.h"
#include "server/service/protocol/message.h"
#include "server/service/store/store.h"

namespace facetless {

struct ServiceLimits {
  int queue = 64;      // number of jobs that may wait
  int waiters = 32;    // number of requests that may wait for a job; further requests are answered at once
  int listeners = 32;  // number of event streams
  double timeout_s = 300;  // longest wait of a request; also the time limit of an upload
  std::uint64_t max_upload_bytes = std::uint64_t{256} << 20;
  std::uint64_t max_samples = 1 << 25;  // limit for one request: pixels × samples per pixel × views
  bool operations_apart = false;        // /metrics is served for HttpRequest::operations only
  HostPolicy hosts;                     // the hosts and origins for which requests are answered
};

class Service {
 public:
  // `store`, `jobs` and `access` must outlive the service.
  Service(Store& store, Jobs& jobs, AccessControl& access, const ServiceLimits& limits);

  // Returns a response if the request is refused: 401, 403, 404, 405, 413, 415, 429 or 503. It examines only
  // the method, the path and the headers. It sets request.caller, which Handle uses.
  std::optional<HttpResponse> Check(HttpRequest& request);
  HttpResponse Handle(const HttpRequest& request);

  const ServiceLimits& limits() const { return limits_; }
  Store& store() { return store_; }

  // Both functions may be empty, and must be set before the first request.
  std::function<std::string(const MetricsNow&)> metrics_text;  // the body of /metrics
  std::function<void(JobKind kind, bool found)> looked_up;     // was the answer there already?

 private:
  HttpResponse Health();
  HttpResponse Ready();
  HttpResponse MetricsPage();
  std::string WhyNotReady();
  HttpResponse Page(const std::string& name, const std::string& content_type) const;
  HttpResponse Artifact(const HttpRequest& request, const std::string& name);
  HttpResponse GetModel(const Caller& caller, const std::string& id);
  HttpResponse ListModels(const HttpRequest& request);
  HttpResponse RemoveModel(const Caller& caller, const std::string& id);
  HttpResponse ListJobs(const HttpRequest& request);
  HttpResponse GetAnswer(const Caller& caller, const std::string& key);
  std::optional<JobView> FindJob(const Caller& caller, const std::string& id);
  HttpResponse GetJob(const Caller& caller, const std::string& id);
  HttpResponse CancelJob(const Caller& caller, const std::string& id);
  HttpResponse JobEvents(const Caller& caller, const std::string& id);
  HttpResponse Submit(const HttpRequest& request, JobKind kind);
  std::optional<std::string> KnownAnswer(const std::string& owner, const Submission& submission);
  Result<void> StoreUploads(const Caller& caller, const Submission& submission, NewJob& job,
                            std::vector<StoredFile>& kept);
  HttpResponse WaitAndAnswer(const HttpRequest& request, const Submitted& submitted,
                             std::chrono::steady_clock::time_point arrived);

  Store& store_;
  Jobs& jobs_;
  AccessControl& access_;
  const ServiceLimits limits_;
  std::mutex ready_mutex_;
  std::chrono::steady_clock::time_point ready_until_;  // until then, why_not_ready_ is considered current
  std::string why_not_ready_;
  std::atomic<int> waiters_{0};
  std::shared_ptr<std::atomic<int>> listeners_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace facetless
