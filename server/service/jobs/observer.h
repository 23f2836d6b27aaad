// What happens in the service's jobs, for whoever counts it or writes it down.
//
//  1. Each is called from many threads, at the end of what it is about, and must not wait for anything.
//  2. Any of them may be empty.
#pragma once

#include <functional>
#include <string>

#include "server/service/jobs/job_store.h"

namespace facetless {

struct Observer {
  // Done, failed or cancelled, as it was stored; how long its last attempt ran, 0 if it never did. Not the
  // difference of the job's own times: the date may have been set in between.
  std::function<void(const Job& job, double seconds)> job_ended;
  std::function<void(const std::string& stage, double seconds)> stage_ended;
  std::function<void(double rays, double seconds)> traced;  // one view of the direct renderer
  std::function<void(double seconds)> model_read;           // a model's file, into memory
  // crash, timeout, memory, output, threads or answer (import_process.h).
  std::function<void(const std::string& cause)> importer_died;
};

}  // namespace facetless
