// `facetless serve`: the service as a process.
#pragma once

#include <cstdint>
#include <string>

namespace facetless {

struct ServeOptions {
  std::string listen = "127.0.0.1:8080";
  std::string ops_listen;    // empty: health and metrics are where everything else is
  std::string log = "auto";  // service_log.h
  std::string data;          // empty: DefaultDataDirectory()
  int jobs = 2, queue = 64;
  std::uint64_t max_upload_mb = 256;
  std::uint64_t max_samples = 1 << 25;
  double timeout_s = 300;
  std::uint64_t import_memory_mb = 8192;
  std::uint64_t max_view_memory_mb = 2048;  // of all jobs that run at the same time
  std::uint64_t max_store_mb = 0;           // 0: none
  double max_age_days = 0;                  // 0: none
  std::string allow_host,
      allow_origin;           // hosts.h: names by which the service is reached, origins of pages that may ask
  bool require_keys = false;  // also on an address of this machine only
  bool allow_anonymous = false;  // also on an address that others reach
};

// $XDG_CACHE_HOME/facetless, else $HOME/.cache/facetless, else ./facetless-data.
std::string DefaultDataDirectory();

// Whoever has no key (keys.h) is let in on an address that only this machine reaches, elsewhere not, unless
// the options say otherwise. It does not start where nobody could come in.
//
// Prints the address to standard output when it is ready, and that of ops_listen on a second line, and its
// log (service_log.h) to standard error, until SIGINT or SIGTERM: then it accepts nothing more, gives running
// jobs a few seconds, puts those that are not finished back into the queue for the next start, and returns an
// exit code. Health and metrics are answered until the end where they have a listener of their own.
int Serve(const ServeOptions& options);

}  // namespace facetless
