// The events of jobs, for the metrics and the log.
//
//  1. Each function is called from many threads, at the end of the event that it reports, and must not block.
//  2. Each function may be empty.
#pragma once

#include <functional>
#include <string>

#include "server/service/jobs/job_store.h"

namespace facetless {

struct Observer {
  // `job` is done, failed or cancelled, as it was stored. `seconds` is the duration of its last attempt, 0 if
  // it never ran. It is not the difference of the job's times, because the clock may have been set in
  // between.
  std::function<void(const Job& job, double seconds)> job_ended;
  std::function<void(const std::string& stage, double seconds)> stage_ended;
  std::function<void(double rays, double seconds)> traced;  // one view of the direct renderer
  std::function<void(double seconds)> model_read;           // a model's file, into memory
  std::function<void(bool forked)> importer_ended;          // however it ended; import_process.h
  // `cause` is crash, timeout, memory, output, threads or answer (import_process.h).
  std::function<void(const std::string& cause)> importer_died;
};

}  // namespace facetless
