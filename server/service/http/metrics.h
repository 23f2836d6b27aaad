// What the service counts, in the text format of Prometheus: docs/api.md, "Metrics", lists the names.
//
//  1. Everything may be called from many threads.
//  2. No label takes what a caller chose: routes are patterns, methods and stages those that are known. So
//     the number of series has a bound, and no name of a file or a key is among them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/service/jobs/job_kinds.h"

namespace facetless {

// What is so at the moment that somebody asks.
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
  // `seconds`: from its start; of one that never started 0.
  void JobEnded(JobKind kind, const std::string& state, double seconds);
  void StageEnded(const std::string& stage, double seconds);
  void Traced(double rays, double seconds);
  void ModelRead(double seconds);
  void ImporterDied(const std::string& cause);
  // Whether the answer to a question of this kind was there already.
  void LookedUp(JobKind kind, bool found);

  std::string Text(const MetricsNow& now);

 private:
  struct Families;
  std::unique_ptr<Families> families_;
};

}  // namespace facetless
