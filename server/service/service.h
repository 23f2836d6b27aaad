// The HTTP service without HTTP: requests in, responses out. docs/api.md is its contract with callers.
//
//  1. Handle may be called from many threads. Work is a job (jobs.h): it is in the job store before anything of
//     it happens, and a request waits for its end only as long as the caller wants.
//  2. Check looks at a request before its body is read: what fails there would fail afterwards, too.
//  3. A question that was answered before costs a look-up, however full the queue is.
//  4. Every error is a problem document (problem.h). No message shows where the service keeps its files.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "server/service/jobs.h"
#include "server/service/message.h"
#include "server/service/store.h"
#include "server/service/submission.h"

namespace facetless {

struct ServiceLimits {
  int queue = 64;          // jobs that wait
  int waiters = 32;        // requests that wait for a job's end; more are answered at once
  int listeners = 32;      // event streams
  double timeout_s = 300;  // the longest wait; an upload has as long
  std::uint64_t max_upload_bytes = std::uint64_t{256} << 20;
};

class Service {
 public:
  // `store` and `jobs` must outlive the service.
  Service(Store& store, Jobs& jobs, const ServiceLimits& limits);

  // A response if the request must not go on: 404, 405, 403, 411, 413, 415, 503. Only method, path and
  // headers are looked at.
  std::optional<HttpResponse> Check(const HttpRequest& request);
  HttpResponse Handle(const HttpRequest& request);

  const ServiceLimits& limits() const { return limits_; }
  Store& store() { return store_; }

 private:
  HttpResponse Health();
  HttpResponse Page(const std::string& name, const std::string& content_type) const;
  HttpResponse Artifact(const HttpRequest& request, const std::string& name);
  HttpResponse GetModel(const std::string& id);
  HttpResponse GetAnswer(const std::string& key);
  HttpResponse GetJob(const std::string& id);
  HttpResponse CancelJob(const std::string& id);
  HttpResponse JobEvents(const std::string& id);
  HttpResponse Submit(const HttpRequest& request, const std::string& kind);
  std::optional<std::string> KnownAnswer(const Submission& submission);
  Result<void> KeepUploads(const Submission& submission, NewJob& job, std::vector<KeptFile>& kept);
  HttpResponse WaitAndAnswer(const HttpRequest& request, const Submitted& submitted);

  Store& store_;
  Jobs& jobs_;
  const ServiceLimits limits_;
  const std::string owner_;  // of everything, until there are keys
  std::atomic<int> waiters_{0};
  std::shared_ptr<std::atomic<int>> listeners_ = std::make_shared<std::atomic<int>>(0);
};

}  // namespace facetless
