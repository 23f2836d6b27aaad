#include "server/service/serve.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "server/commands.h"
#include "server/exit_code.h"
#include "server/interrupt.h"
#include "server/service/access.h"
#include "server/service/data_directory.h"
#include "server/service/file_store.h"
#include "server/service/http_server.h"
#include "server/service/jobs.h"
#include "server/service/keys.h"
#include "server/service/service.h"
#include "server/service/sql_job_store.h"

namespace facetless {
namespace {

// How long running jobs may go on after the signal: container runtimes kill after ten seconds.
constexpr double kGraceSeconds = 5;
constexpr auto kPoll = std::chrono::milliseconds(50);

struct Address {
  std::string host;
  int port = 0;
};

// "127.0.0.1:8080", "[::1]:8080", "localhost:0".
Result<Address> ParseAddress(const std::string& text) {
  const Error error = {ErrorCode::kBadUsage,
                       "--listen is " + text + ", but must be ADDRESS:PORT, like 127.0.0.1:8080"};
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

// Control characters would forge lines of the log.
std::string Printable(const std::string& text) {
  std::string printable;
  for (const char c : text) printable += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return printable;
}

bool OnlyThisMachineReaches(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

// Are callers without a key let in? Error: kBadUsage if nobody could be.
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
                                         data + " --name NAME, or let everybody in with --allow-anonymous"};
}

constexpr double kDaySeconds = 24 * 3600;

StoreLimits StoreLimitsOf(const ServeOptions& options) {
  return {options.max_store_mb << 20, options.max_age_days * kDaySeconds};
}

JobSettings JobSettingsOf(const ServeOptions& options, const std::string& data) {
  JobSettings settings;
  settings.workers = options.jobs;
  settings.run.timeout_s = options.timeout_s;
  settings.run.max_samples = options.max_samples;
  settings.run.import_memory_mb = options.import_memory_mb;
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
  auto address = ParseAddress(options.listen);
  if (!address) return PrintError(address.error());
  const std::string data =
      std::filesystem::absolute(options.data.empty() ? DefaultDataDirectory() : options.data);
  // A file that grows beyond what the system allows is an error of that write, and no end of the service.
  std::signal(SIGXFSZ, SIG_IGN);
  auto directory = DataDirectory::Open(data);
  if (!directory) return PrintError(directory.error());
  auto store = FileStore::Open(*directory.value(), StoreLimitsOf(options));
  if (!store) return PrintError(store.error());

  KeyStore keys(directory.value()->reader());
  auto anonymous = AnonymousAllowed(options, address.value().host, data, keys);
  if (!anonymous) return PrintError(anonymous.error());
  AccessControl access(keys, anonymous.value());

  // The queue, the service and its transport. Of several owners, none may have more than half of the queue.
  QueueLimits queue_limits;
  queue_limits.queued = options.queue;
  queue_limits.queued_of_owner = (options.queue + 1) / 2;
  SqlJobStore queue(*directory.value(), queue_limits);
  Jobs jobs(queue, *store.value(), JobSettingsOf(options, data));
  ServiceLimits limits;
  limits.queue = options.queue;
  limits.timeout_s = options.timeout_s;
  limits.max_upload_bytes = options.max_upload_mb << 20;
  Service service(*store.value(), jobs, access, limits);
  auto server = HttpServer::Bind(service, address.value().host, address.value().port);
  if (!server) return PrintError(server.error());
  const auto log = spdlog::stderr_logger_mt("facetless");
  log->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  access.audit = [&](const std::string& line) { log->info("audit {}", Printable(line)); };
  server.value()->on_request = [&](const std::string& method, const std::string& path, int status,
                                   double ms) {
    log->info("{} {} {} {:.0f} ms", method, Printable(path), status, ms);
  };

  // Serve until a signal comes.
  std::atomic<bool> ended{false};
  std::thread serving([&] {
    if (!server.value()->Run()) log->error("the listening socket failed");
    ended = true;
  });
  const bool ipv6 = address.value().host.find(':') != std::string::npos;
  std::printf("http://%s%s%s:%d\n", ipv6 ? "[" : "", address.value().host.c_str(), ipv6 ? "]" : "",
              server.value()->port());
  std::fflush(stdout);
  log->info("serving on port {}, data in {}, {} jobs at a time, {} may wait", server.value()->port(), data,
            options.jobs, options.queue);
  while (!InterruptFlag() && !ended) std::this_thread::sleep_for(kPoll);

  // Stop: nothing new, a few seconds for what runs; the rest waits for the next start.
  const bool asked = InterruptFlag();
  log->info("stopping");
  std::thread grace([&] { jobs.Stop(kGraceSeconds); });
  server.value()->Stop();
  grace.join();
  serving.join();
  return asked ? kExitDone : kExitInternal;
}

}  // namespace facetless
