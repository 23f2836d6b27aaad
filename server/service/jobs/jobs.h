// The queue at work: threads that claim jobs, run them and report what becomes of them.
//
//  1. `workers` jobs run at the same time at most. A job's end is in the job store before anybody is told.
//  2. Cancel of a running job ends its work within a fraction of a second: the importer is killed with its
//     group, the renderer polls a flag.
//  3. Stop claims nothing more, lets running jobs go on for a while, and gives back what is not finished
//     then.
//  4. Whoever waits or listens is woken at the job's end, and at Stop when the job will not end here.
//  5. No exception leaves a job: what it throws, lack of memory included, is its failure.
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

// A job and how far it is.
struct JobView {
  Job job;
  std::string stage;  // queued, starting, one of the importer's or the run's, or the state that it ended in
  double fraction = 0;
  std::vector<std::string> messages;  // of this attempt, so far
  std::uint64_t version = 0;          // rises when anything of this changes
};

struct JobSettings {
  int workers = 2;
  RunLimits run;
  double forget_after_s = 0;      // how long jobs that ended are remembered; 0: by number only
  std::string private_directory;  // paths below it are cut from problems
  Observer observer;
};

class Jobs {
 public:
  // Gives back what a dead process was running, and starts. Both stores must outlive it.
  Jobs(JobStore& queue, Store& store, const JobSettings& settings);
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  Result<Submitted> Submit(const NewJob& job);
  std::optional<JobView> Find(const std::string& id);
  // JobStore::List.
  std::optional<std::vector<std::string>> List(const std::string& owner, const std::string& after,
                                               std::size_t limit) {
    return queue_.List(owner, after, limit);
  }
  // The job when it has ended, or when `seconds` are over.
  std::optional<JobView> WaitForEnd(const std::string& id, double seconds);
  // The same for any change since `version`.
  std::optional<JobView> WaitForChange(const std::string& id, std::uint64_t version, double seconds);
  // Waits up to a second for running work to end. Nothing if there is no such job.
  Result<std::optional<JobView>> Cancel(const std::string& id);
  JobCounts Counts() { return queue_.Counts(); }
  // Nothing, if a job would be taken now and run here.
  Result<void> Check() { return queue_.Check(); }

  // Stops, with so many seconds of grace; may be called more than once.
  void Stop(double grace_s);
  bool stopping() const { return stopping_; }

 private:
  struct Active;

  void Work();
  void Keep();
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
  std::condition_variable changed_;  // work came, progress was made, a job ended, or it is time to stop
  std::map<std::string, std::shared_ptr<Active>> active_;
  std::uint64_t arrivals_ = 0, changes_ = 0;
  std::atomic<bool> stopping_{false};
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace facetless
