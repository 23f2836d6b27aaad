#include "server/service/serve.h"

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>
#include <utility>

#include "server/base/exit_code.h"
#include "server/base/heap.h"
#include "server/base/interrupt.h"
#include "server/importer/import_process.h"
#include "server/service/access/access.h"
#include "server/service/access/keys.h"
#include "server/service/http/http_server.h"
#include "server/service/http/metrics.h"
#include "server/service/http/service.h"
#include "server/service/http/service_log.h"
#include "server/service/jobs/jobs.h"
#include "server/service/jobs/sql_job_store.h"
#include "server/service/store/data_directory.h"
#include "server/service/store/file_store.h"

namespace facetless {
namespace {

// The time for which running jobs may continue after the signal. Container runtimes kill after ten seconds.
constexpr double kGraceSeconds = 5;
constexpr auto kPoll = std::chrono::milliseconds(50);

struct Address {
  std::string host;
  int port = 0;
};

// Parses an address such as "127.0.0.1:8080", "[::1]:8080" or "localhost:0".
Result<Address> ParseAddress(const std::string& option, const std::string& text) {
  const Error error = {ErrorCode::kBadUsage,
                       option + " is " + text + ", but must be ADDRESS:PORT, like 127.0.0.1:8080"};
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return error;
  Address address;
  address.host = text.substr(0, colon);
  if (address.host.front() == '[' && address.host.back() == ']')
    address.host = address.host.substr(1, address.host.size() - 2);
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, address.port);
  if (parsed.ec != std::errc{} || parsed.ptr != end || address.port < 0 || address.port > 65535) return error;
  return address;
}

bool OnlyThisMachineReaches(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

// Returns whether callers without a key are allowed. Error: kBadUsage (keys are required, but there is none).
Result<bool> AnonymousAllowed(const ServeOptions& options, const std::string& host, const std::string& data,
                              KeyStore& keys) {
  if (options.allow_anonymous) return true;
  if (!options.require_keys && OnlyThisMachineReaches(host)) return true;
  auto known = keys.List();
  if (!known) return known.error();
  for (const AccessKey& key : known.value()) {
    if (key.revoked == 0) return false;
  }
  return Error{ErrorCode::kBadUsage, "others reach " + options.listen +
                                         ", and there is no key: make one with facetless keys create " +
                                         data + " --name NAME, or allow every client with --allow-anonymous"};
}

constexpr double kDaySeconds = 24 * 3600, kMillisecond = 1e-3;

StoreLimits MakeStoreLimits(const ServeOptions& options) {
  return {options.max_store_mb << 20, options.max_age_days * kDaySeconds};
}

// The observer that counts the events of jobs and logs them.
Observer MakeObserver(Metrics& metrics, ServiceLog& log) {
  Observer observer;
  observer.job_ended = [&](const Job& job, double seconds) {
    metrics.JobEnded(job.kind, JobStateName(job.state), seconds);
    log.Write(JobEntry(job, seconds));
  };
  observer.stage_ended = [&](const std::string& stage, double seconds) {
    metrics.StageEnded(stage, seconds);
  };
  observer.traced = [&](double rays, double seconds) { metrics.Traced(rays, seconds); };
  observer.model_read = [&](double seconds) { metrics.ModelRead(seconds); };
  observer.importer_ended = [&](bool forked) { metrics.ImporterEnded(forked); };
  observer.importer_died = [&](const std::string& cause) { metrics.ImporterDied(cause); };
  return observer;
}

LogEntry ServiceEntry(const std::string& text, const std::string& level = "info") {
  return {level, "service", text, nlohmann::json::object()};
}

// Serves one listener in a thread until it is stopped.
class Serving {
 public:
  Serving(HttpServer& server, ServiceLog& log)
      : server_(server), thread_([this, &log] {
          if (!server_.Run()) log.Write(ServiceEntry("the listening socket failed", "error"));
          ended_ = true;
        }) {}
  ~Serving() { Stop(); }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;

  bool ended() const { return ended_; }
  // Stops the server, and returns when every request has been answered. May be called more than once.
  void Stop() {
    if (!thread_.joinable()) return;
    server_.Stop();
    thread_.join();
  }

 private:
  HttpServer& server_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

void PrintAddress(const char* prefix, const Address& address, int port) {
  const bool ipv6 = address.host.find(':') != std::string::npos;
  std::printf("%shttp://%s%s%s:%d\n", prefix, ipv6 ? "[" : "", address.host.c_str(), ipv6 ? "]" : "", port);
  std::fflush(stdout);
}

JobSettings MakeJobSettings(const ServeOptions& options, const std::string& data) {
  JobSettings settings;
  settings.workers = options.jobs;
  settings.run.timeout_s = options.timeout_s;
  settings.run.max_samples = options.max_samples;
  settings.run.import_memory_mb = options.import_memory_mb;
  // Each job renders one view at a time.
  settings.run.max_view_bytes = (options.max_view_memory_mb << 20) / static_cast<std::uint64_t>(options.jobs);
  settings.forget_after_s = options.max_age_days * kDaySeconds;
  settings.private_directory = data;
  return settings;
}

}  // namespace

std::string DefaultDataDirectory() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty()) return cache + "/facetless";
  if (const std::string home = variable("HOME"); !home.empty()) return home + "/.cache/facetless";
  return "facetless-data";
}

int Serve(const ServeOptions& options) {
  LimitHeapArenas();
  auto address = ParseAddress("--listen", options.listen);
  if (!address) return PrintError(address.error());
  const bool apart = !options.ops_listen.empty();
  auto operations_address = ParseAddress("--ops-listen", apart ? options.ops_listen : options.listen);
  if (!operations_address) return PrintError(operations_address.error());
  const std::string data =
      std::filesystem::absolute(options.data.empty() ? DefaultDataDirectory() : options.data);
  // A file that exceeds the limit of the system must cause a write error and not end the service.
  std::signal(SIGXFSZ, SIG_IGN);
  auto directory = DataDirectory::Open(data);
  if (!directory) return PrintError(directory.error());
  auto store = FileStore::Open(*directory.value(), MakeStoreLimits(options));
  if (!store) return PrintError(store.error());

  KeyStore keys(directory.value()->reader());
  auto anonymous = AnonymousAllowed(options, address.value().host, data, keys);
  if (!anonymous) return PrintError(anonymous.error());
  AccessControl access(keys, anonymous.value());
  Metrics metrics;
  ServiceLog log(options.log);

  // Create the queue, the service and its transport. If there are several owners, none may use more than half
  // of the queue.
  QueueLimits queue_limits;
  queue_limits.queued = options.queue;
  queue_limits.queued_of_owner = (options.queue + 1) / 2;
  SqlJobStore queue(*directory.value(), queue_limits);
  JobSettings settings = MakeJobSettings(options, data);
  settings.observer = MakeObserver(metrics, log);
  // One importer stays loaded and forks a child for each file. It outlives the jobs.
  ForkServerSettings loaded_importer = ImporterForkServer();
  loaded_importer.log = [&](const std::string& sentence) { log.Write(ServiceEntry(sentence, "warning")); };
  ForkServer fork_server(std::move(loaded_importer));
  settings.fork_server = &fork_server;
  Jobs jobs(queue, *store.value(), settings);
  ServiceLimits limits;
  limits.queue = options.queue;
  limits.timeout_s = options.timeout_s;
  limits.max_upload_bytes = options.max_upload_mb << 20;
  limits.max_samples = options.max_samples;
  limits.operations_apart = apart;
  // On a loopback address without keys, other sites could reach the service through the browsers of its
  // users, so check hosts and origins.
  if ((anonymous.value() && OnlyThisMachineReaches(address.value().host)) || !options.allow_host.empty() ||
      !options.allow_origin.empty())
    limits.hosts = HostPolicy(SplitList(options.allow_host), SplitList(options.allow_origin));
  Service service(*store.value(), jobs, access, limits);
  service.metrics_text = [&](const MetricsNow& now) { return metrics.Text(now); };
  service.looked_up = [&](JobKind kind, bool found) { metrics.LookedUp(kind, found); };
  access.audit = [&](const std::string& decision, const HttpRequest& request) {
    log.Write(AuditEntry(decision, request));
  };
  const auto bind = [&](const Address& at, bool operations) {
    auto server = HttpServer::Bind(service, {at.host, at.port, operations});
    if (server)
      server.value()->on_request = [&](const ServedRequest& request) {
        metrics.RequestServed(FindRoute(request.path).pattern, request.method, request.status,
                              request.ms * kMillisecond);
        log.Write(RequestEntry(request));
      };
    return server;
  };
  auto server = bind(address.value(), false);
  if (!server) return PrintError(server.error());
  std::unique_ptr<HttpServer> operations_server;
  if (apart) {
    auto bound = bind(operations_address.value(), true);
    if (!bound) return PrintError(bound.error());
    operations_server = std::move(bound).value();
  }

  // Serve until a signal arrives.
  std::unique_ptr<Serving> operations;
  if (operations_server) operations = std::make_unique<Serving>(*operations_server, log);
  Serving serving(*server.value(), log);
  PrintAddress("", address.value(), server.value()->port());
  if (operations_server)
    PrintAddress("health and metrics: ", operations_address.value(), operations_server->port());
  log.Write(ServiceEntry("serving on port " + std::to_string(server.value()->port()) + ", data in " + data +
                         ", " + std::to_string(options.jobs) + " jobs at a time, " +
                         std::to_string(options.queue) + " may wait"));
  while (!InterruptFlag() && !serving.ended()) std::this_thread::sleep_for(kPoll);

  // Stop: accept nothing new, and let running jobs continue for a few seconds. Other jobs wait for the next
  // start. Health and metrics are served until the end.
  const bool asked = InterruptFlag();
  log.Write(ServiceEntry("stopping"));
  std::thread grace([&] { jobs.Stop(kGraceSeconds); });
  serving.Stop();
  grace.join();
  operations.reset();
  return asked ? kExitDone : kExitInternal;
}

}  // namespace facetless
