// The HTTP service without HTTP: requests in, responses out. docs/api.md is its contract with callers.
//
//  1. Handle may be called from many threads. At most `jobs` runs (imports, renderings) happen at the same
//     time, at most `queue` requests wait for one; others get 503. A run ends at its request's deadline (504)
//     or when `stop` is set (503).
//  2. Check looks at a request before its body is read: what fails there would fail afterwards, too.
//  3. Every error is a problem document (problem.h). No message shows where the service keeps its files.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "server/interrupt.h"
#include "server/run.h"
#include "server/service/message.h"
#include "server/service/store.h"

namespace facetless {

struct ServiceLimits {
  int jobs = 2;
  int queue = 16;
  double timeout_s = 300;  // of one request, waiting included, upload not
  std::uint64_t max_upload_bytes = std::uint64_t{256} << 20;
  std::uint64_t max_samples = 1 << 25;  // pixels × samples per pixel × views
  std::uint64_t import_memory_mb = 8192;
  std::string private_directory;  // paths below it are cut from messages
};

class Service {
 public:
  // `store` and `stop` must outlive the service.
  Service(Store& store, const ServiceLimits& limits, const std::atomic<bool>& stop);

  // A response if the request must not go on: 404, 405, 403, 411, 413, 415, 503. Only method, path and
  // headers are looked at.
  std::optional<HttpResponse> Check(const HttpRequest& request) const;
  HttpResponse Handle(const HttpRequest& request);

  const ServiceLimits& limits() const { return limits_; }
  Store& store() { return store_; }

 private:
  class Slot;

  HttpResponse Health() const;
  HttpResponse Page(const std::string& name, const std::string& content_type) const;
  HttpResponse Artifact(const HttpRequest& request, const std::string& name);
  HttpResponse GetModel(const std::string& id);
  HttpResponse PostModel(const HttpRequest& request);
  HttpResponse PostRun(const HttpRequest& request, bool compare);

  // These three need a Slot.
  Result<StoredModel> ImportModel(const BodyPart& file, const Deadline& deadline,
                                  const std::optional<TessellationOptions>& mesh);
  Result<std::string> EnsureMesh(const StoredModel& model, const TessellationOptions& mesh,
                                 const Deadline& deadline);
  Result<nlohmann::json> Execute(const StoredModel& model, const std::string& mesh_path,
                                 const RunOptions& options, bool compare, const Deadline& deadline);
  Result<ImportedFiles> RunImport(const std::string& path, const std::vector<TessellationOptions>& meshes,
                                  const Deadline& deadline);
  Result<nlohmann::json> Publish(nlohmann::json report, const std::string& directory, const std::string& id);
  HttpResponse Failed(const Error& error, const Deadline& deadline) const;

  Store& store_;
  const ServiceLimits limits_;
  const std::atomic<bool>& stop_;
  mutable std::mutex mutex_;
  std::condition_variable slot_freed_;
  int running_ = 0, waiting_ = 0;
};

}  // namespace facetless
