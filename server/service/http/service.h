// The HTTP service without HTTP: requests in, responses out. docs/api.md is its contract with callers.
//
//  1. Handle may be called from many threads. Work is a job (jobs.h): it is in the job store before anything
//     of it happens, and a request waits for its end only as long as the caller wants.
//  2. Check looks at a request before its body is read: what fails there would fail afterwards, too.
//  3. A question that was answered before costs a look-up, however full the queue is.
//  4. What a caller sees and may do is decided by access.h; what is another owner's is not there.
//  5. Every error is a problem document (problem.h). No message shows where the service keeps its files.
//  6. Where health and metrics have a listener of their own (HttpRequest::operations), there is nothing else
//     on it, and /metrics is nowhere else.
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
  int queue = 64;          // jobs that wait
  int waiters = 32;        // requests that wait for a job's end; more are answered at once
  int listeners = 32;      // event streams
  double timeout_s = 300;  // the longest wait; an upload has as long
  std::uint64_t max_upload_bytes = std::uint64_t{256} << 20;
  std::uint64_t max_samples = 1 << 25;  // of one request: pixels × samples per pixel × views
  bool operations_apart = false;        // /metrics is for HttpRequest::operations only
  HostPolicy hosts;                     // which hosts and origins are answered for
};

class Service {
 public:
  // All must outlive the service.
  Service(Store& store, Jobs& jobs, AccessControl& access, const ServiceLimits& limits);

  // A response if the request must not go on: 401, 403, 404, 405, 413, 415, 429, 503. Only method, path and
  // headers are looked at. Sets request.caller, which Handle goes by.
  std::optional<HttpResponse> Check(HttpRequest& request);
  HttpResponse Handle(const HttpRequest& request);

  const ServiceLimits& limits() const { return limits_; }
  Store& store() { return store_; }

  // Both are to be set before the first request, and may be empty.
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
  Result<void> KeepUploads(const Caller& caller, const Submission& submission, NewJob& job,
                           std::vector<KeptFile>& kept);
  HttpResponse WaitAndAnswer(const HttpRequest& request, const Submitted& submitted,
                             std::chrono::steady_clock::time_point arrived);

  Store& store_;
  Jobs& jobs_;
  AccessControl& access_;
  const ServiceLimits limits_;
  std::mutex ready_mutex_;
  std::chrono::steady_clock::time_point ready_until_;  // until then, why_not_ready_ is taken for true
  std::string why_not_ready_;
  std::atomic<int> waiters_{0};
  std::shared_ptr<std::atomic<int>> listeners_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace facetless
