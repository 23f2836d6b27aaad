// The job runner: threads that claim jobs from the queue, run them and report their progress and their ends.
//
//     Jobs jobs(queue, store, {.workers = 2});
//     Result<Submitted> submitted = jobs.Submit(job);
//     std::optional<JobView> view = jobs.WaitForEnd(submitted.value().job.id, /*seconds=*/10);
//
//  1. At most `workers` jobs run at the same time. The end of a job is in the job store before any caller is
//     notified.
//  2. Cancelling a running job ends its work within a fraction of a second: the importer is killed with its
//     process group, and the renderer polls a flag.
//  3. Stop claims no more jobs, lets running jobs continue for the grace period, and returns unfinished jobs
//     to the queue.
//  4. Callers that wait for a job are woken when the job ends, and at Stop if the job will not end in this
//     process.
//  5. No exception leaves a job. A job that throws, even for lack of memory, fails.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/service/jobs/job_store.h"
#include "server/service/jobs/observer.h"
#include "server/service/jobs/run_job.h"
#include "server/service/store/store.h"

namespace facetless {

// A job and its progress.
struct JobView {
  Job job;
  std::string stage;  // queued, starting, a stage of the importer or of the run, or the final state
  double fraction = 0;
  std::vector<std::string> messages;  // messages of this attempt so far
  std::uint64_t version = 0;          // increases with every change of the view
};

struct JobSettings {
  int workers = 2;
  RunLimits run;
  double forget_after_s =
      0;  // time after which ended jobs are deleted, seconds; 0: only their number is limited
  std::string private_directory;  // paths below this directory are removed from problem documents
  Observer observer;
  ForkServer* fork_server =
      nullptr;  // of the importer, which outlives the runner; null: each import starts it
};

class Jobs {
 public:
  // Returns the jobs of a dead process to the queue, and starts the threads. Both stores must outlive this
  // object.
  Jobs(JobStore& queue, Store& store, const JobSettings& settings);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  Result<Submitted> Submit(const NewJob& job);
  std::optional<JobView> Find(const std::string& id);
  // Calls JobStore::List.
  std::optional<std::vector<std::string>> List(const std::string& owner, const std::string& after,
                                               std::size_t limit) {
    return queue_.List(owner, after, limit);
  }
  // Waits until the job has ended, at most `seconds`, and returns the job.
  std::optional<JobView> WaitForEnd(const std::string& id, double seconds);
  // Waits until the view differs from `version`, at most `seconds`, and returns the job.
  std::optional<JobView> WaitForChange(const std::string& id, std::uint64_t version, double seconds);
  // Cancels a job, and waits up to a second for running work to end. Nothing if there is no such job.
  Result<std::optional<JobView>> Cancel(const std::string& id);
  JobCounts Counts() { return queue_.Counts(); }
  // Succeeds if a job would be accepted now.
  Result<void> Check() { return queue_.Check(); }

  // Stops with a grace period of `grace_s` seconds (law 3). May be called more than once.
  void Stop(double grace_s);
  bool stopping() const { return stopping_; }

 private:
  struct Active;

  void Work();
  void MaintainLeases();
  void Run(const std::shared_ptr<Active>& active);
  Job Ended(const Active& active, const Result<std::string>& result, bool expired) const;
  void EnterStage(Active& active, const std::string& stage) const;
  void RecordEnd(Job ended, double seconds);
  std::optional<JobView> Wait(const std::string& id, double seconds,
                              const std::function<bool(const JobView&)>& enough);

  JobStore& queue_;
  Store& store_;
  const JobSettings settings_;
  const std::string worker_;
  std::mutex mutex_;
  std::condition_variable changed_;  // notified when a job arrives, makes progress or ends, and at Stop
  std::map<std::string, std::shared_ptr<Active>> active_;
  std::uint64_t arrivals_ = 0, changes_ = 0;
  std::atomic<bool> stopping_{false};
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace facetless
