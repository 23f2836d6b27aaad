// Runs one job, from its inputs to an answer in the store.
//
//  1. Results that are in the store are not made again, and new results are stored before RunJob returns.
//     After a crash, or at a second attempt, the work therefore continues where it ended.
//  2. If the mesh of a comparison cannot be made, the answer has the exact half only, and the reason. Meshing
//     may take at most half of the job's time, so that time remains for the exact half.
//  3. The files of a run are written to a scratch directory and moved to the store from there, so nothing
//     remains of a failed run.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "render/base/result.h"
#include "server/base/interrupt.h"
#include "server/importer/fork_server.h"
#include "server/service/jobs/job_store.h"
#include "server/service/jobs/observer.h"
#include "server/service/store/store.h"

namespace facetless {

struct RunLimits {
  double timeout_s = 300;               // time limit of one attempt
  std::uint64_t max_samples = 1 << 25;  // pixels × samples per pixel × views
  std::uint64_t import_memory_mb = 8192;
  std::uint64_t max_view_bytes = std::uint64_t{2} << 30;  // memory limit for the leaves of one view
};

struct JobWatch {
  const Deadline* deadline = nullptr;  // ends the job with kCancelled
  std::function<void(const std::string& stage, double fraction)> progress;
  std::function<void(const std::string& sentence)> message;  // information for the user during the job
  const Observer* observer = nullptr;
  ForkServer* fork_server = nullptr;  // of the importer
};

// Runs a job and returns the item that contains the answer (store.h). Errors: the errors of the importer, of
// ReadModel, of LoadMesh and of the runs; kLimitExceeded; kWriteFailed; kCancelled.
Result<std::string> RunJob(const Job& job, Store& store, const RunLimits& limits, const JobWatch& watch);

}  // namespace facetless
