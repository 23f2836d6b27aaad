// The metrics of the service, in the text format of Prometheus. docs/api.md, "Metrics", lists their names.
//
//  1. All functions may be called from many threads.
//  2. No label has a value that a caller chose: routes are patterns, and methods and stages are from fixed
//     lists. The number of series is therefore bounded, and labels contain no names of files or keys.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/service/jobs/job_kinds.h"

namespace facetless {

// The values at the moment of the request.
struct MetricsNow {
  bool ready = false;
  int jobs_waiting = 0, jobs_running = 0;
  std::uint64_t store_bytes = 0;
};

class Metrics {
 public:
  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  void RequestServed(const std::string& route, const std::string& method, int status, double seconds);
  // `seconds` is the time since the start of the job; 0 for a job that never started.
  void JobEnded(JobKind kind, const std::string& state, double seconds);
  void StageEnded(const std::string& stage, double seconds);
  void Traced(double rays, double seconds);
  void ModelRead(double seconds);
  void ImporterEnded(bool forked);
  void ImporterDied(const std::string& cause);
  // Counts a look-up of an answer of this kind; `found` tells whether the answer existed already.
  void LookedUp(JobKind kind, bool found);

  std::string Text(const MetricsNow& now);

 private:
  struct Families;
  std::unique_ptr<Families> families_;
};

}  // namespace facetless
