// What happens in the service's jobs, for whoever counts it or writes it down.
//
//  1. Each is called from many threads, at the end of what it is about, and must not wait for anything.
//  2. Any of them may be empty.
#pragma once

#include <functional>
#include <string>

#include "server/service/job_store.h"

namespace facetless {

struct Observer {
  std::function<void(const Job& job)> job_ended;  // done, failed or cancelled, as it was stored
  std::function<void(const std::string& stage, double seconds)> stage_ended;
  std::function<void(double rays, double seconds)> traced;  // one view of the direct renderer
  // crash, timeout, memory, output, threads or answer (import_process.h).
  std::function<void(const std::string& cause)> importer_died;
};

}  // namespace facetless
