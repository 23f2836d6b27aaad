// `facetless serve`: the process of the service.
#pragma once

#include <cstdint>
#include <string>

namespace facetless {

struct ServeOptions {
  std::string listen = "127.0.0.1:8080";
  std::string ops_listen;    // empty: health and metrics have no separate listener
  std::string log = "auto";  // service_log.h
  std::string data;          // empty: DefaultDataDirectory()
  int jobs = 2, queue = 64;
  std::uint64_t max_upload_mb = 256;
  std::uint64_t max_samples = 1 << 25;
  double timeout_s = 300;
  std::uint64_t import_memory_mb = 8192;
  std::uint64_t max_view_memory_mb = 2048;  // shared by all jobs that run at the same time
  std::uint64_t max_store_mb = 0;           // 0: no limit
  double max_age_days = 0;                  // 0: no limit
  std::string allow_host,
      allow_origin;  // host names of the service, and origins of pages that may send requests (hosts.h)
  bool require_keys = false;     // require keys even on a loopback address
  bool allow_anonymous = false;  // allow callers without keys even on an address that other hosts can reach
};

// $XDG_CACHE_HOME/facetless, or $HOME/.cache/facetless, or ./facetless-data, whichever is defined first.
std::string DefaultDataDirectory();

// Runs the service until SIGINT or SIGTERM, and returns an exit code.
//
// Unless the options state otherwise, callers without a key (keys.h) are allowed on a loopback address, and
// refused on any other address. The service does not start if keys are required but there is no key.
//
// When the service is ready, it prints its address to standard output, and the address of ops_listen on a
// second line. The log (service_log.h) goes to standard error. After the signal, the service accepts no more
// requests, lets running jobs continue for a few seconds, and returns unfinished jobs to the queue for the
// next start. Health and metrics are served until the end if they have a separate listener.
int Serve(const ServeOptions& options);

}  // namespace facetless
