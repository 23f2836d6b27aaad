// One job from its inputs to an answer in the store.
//
//  1. What is in the store is not made again, and what is made goes in before RunJob returns: after a crash,
//     or at a second attempt, work goes on where it was.
//  2. A comparison whose mesh cannot be made has the exact half alone as its answer, and says why. Meshing
//     may take half of the job's time at most, so that time is left for that.
//  3. The files of a run are written into a scratch directory and moved in from there: nothing of a failed
//     run stays.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "render/base/result.h"
#include "server/base/interrupt.h"
#include "server/service/jobs/job_store.h"
#include "server/service/jobs/observer.h"
#include "server/service/store/store.h"

namespace facetless {

struct RunLimits {
  double timeout_s = 300;               // of one attempt
  std::uint64_t max_samples = 1 << 25;  // pixels × samples per pixel × views
  std::uint64_t import_memory_mb = 8192;
  std::uint64_t max_view_bytes = std::uint64_t{2} << 30;  // of the leaves of one view
};

struct JobWatch {
  const Deadline* deadline = nullptr;  // ends the job with kCancelled
  std::function<void(const std::string& stage, double fraction)> progress;
  std::function<void(const std::string& sentence)> message;  // what a person may want to know on the way
  const Observer* observer = nullptr;
};

// The item that holds the answer (store.h). Errors: those of the importer, of ReadModel, LoadMesh and the
// runs; kLimitExceeded; kWriteFailed; kCancelled.
Result<std::string> RunJob(const Job& job, Store& store, const RunLimits& limits, const JobWatch& watch);

}  // namespace facetless
