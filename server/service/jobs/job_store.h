// What is to be done, for whom, and what came of it. One implementation is in SQLite (sql_job_store.h); one
// for several machines would keep the same laws.
//
//  1. A job is `queued`, then `running`, then one of `done`, `failed`, `cancelled`, for ever. What was
//     submitted is there after a crash of process or machine; a running job goes back to `queued` when its
//     lease is over or its process is known to be dead.
//  2. Every claim is an attempt with a number of its own, and only the latest may renew, finish or release:
//     what an attempt brings that is no longer the job's is refused, so a job ends once.
//  3. A job that was attempted `max_attempts` times without an end has failed. Its last attempt runs alone,
//     so that a job which kills the process takes no other with it each time.
//  4. Claims go round the owners that have something waiting; within an owner, first come first served.
//  5. Of one owner, two jobs with the same question never wait or run at the same time, and one retry key
//     stands for one job.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/base/result.h"
#include "server/service/jobs/job_kinds.h"

namespace facetless {

enum class JobState { kQueued, kRunning, kDone, kFailed, kCancelled };

// "queued", "running", "done", "failed", "cancelled".
const char* JobStateName(JobState state);

struct Job {
  std::string id;  // 128 random bits, hexadecimal
  JobKind kind = JobKind::kModel;
  std::string unknown_kind;  // kUnknown: what the store calls it
  std::string owner;         // the id of a key; "" where there are none
  std::string question;      // digest of what is asked
  nlohmann::json request;    // what is asked, in full
  JobState state = JobState::kQueued;
  double created = 0, started = 0, finished = 0;  // seconds since 1970; 0: not yet
  int attempts = 0;
  std::string result;      // done: the item that is the answer (store.h)
  nlohmann::json problem;  // failed: the problem document

  // The id of the model that is asked about; "" where the request has none.
  std::string ModelId() const { return request.is_object() ? request.value("model", "") : ""; }
  bool Ended() const { return state != JobState::kQueued && state != JobState::kRunning; }
};

// A file that a job owns until its end.
struct JobFile {
  std::string role, sha256;
  std::uint64_t bytes = 0;
};

struct NewJob {
  JobKind kind = JobKind::kModel;
  std::string owner, question;
  nlohmann::json request;
  std::vector<JobFile> files;
  std::vector<std::string> needs;  // items that must stay until its end
  std::string retry_key;           // the caller's own name for this submission; empty: none
  std::string body;                // digest of the submission; compared where the retry key is known
  std::string result;              // not empty: the answer is here already, and the job is done
};

enum class SubmitOutcome {
  kAccepted,
  kSame,       // an earlier job with this question, or this retry key
  kKeyReused,  // the retry key stands for another submission
  kQueueFull,
  kShareFull,  // this owner has as much waiting as one may have
};

struct Submitted {
  SubmitOutcome outcome = SubmitOutcome::kAccepted;
  Job job;  // kAccepted, kSame
};

struct QueueLimits {
  int queued = 64;           // jobs that wait, of all owners
  int queued_of_owner = 64;  // of one that has a name
  int max_attempts = 3;
};

struct JobCounts {
  int queued = 0, running = 0;
};

class JobStore {
 public:
  virtual ~JobStore() = default;

  // Commits the job before it returns. Errors: kWriteFailed.
  virtual Result<Submitted> Submit(const NewJob& job) = 0;

  // The next job, leased to `worker` for so many seconds; nothing if none is to be had.
  virtual Result<std::optional<Job>> Claim(const std::string& worker, double lease_s) = 0;
  // False if the attempt is no longer the job's: its work must stop. `job` is as Claim gave it.
  virtual Result<bool> Renew(const Job& job, double lease_s) = 0;
  // Ends the attempt with job.state, job.result and job.problem. False if it is no longer the job's.
  virtual Result<bool> Finish(const Job& job) = 0;
  // Gives the job back, as if it had not been claimed.
  virtual Result<bool> Release(const Job& job) = 0;

  // Of a queued job: cancels it. Of a running one: notes that it shall be, whatever happens to its process.
  // The job as it is then; nothing if there is none.
  virtual Result<std::optional<Job>> Cancel(const std::string& id) = 0;
  virtual std::optional<Job> Find(const std::string& id) = 0;
  // Ids of an owner's jobs, the newest first, from the first one older than `after` on ("": the newest of
  // all): at most `limit`. Nothing if there is no job `after` of that owner.
  virtual std::optional<std::vector<std::string>> List(const std::string& owner, const std::string& after,
                                                       std::size_t limit) = 0;
  virtual JobCounts Counts() = 0;

  // Returns OK if the store can accept a job. Errors: those of Submit.
  virtual Result<void> Check() = 0;

  // Gives back or fails (law 3) every running job, whatever its lease: to be called when no other process can
  // have any.
  virtual Result<void> Recover() = 0;
  // Forgets jobs that ended before `finished_before`, and the oldest beyond a bound of the implementation's.
  virtual Result<void> Forget(double finished_before) = 0;
};

// "comparison"; of an unknown kind what the store calls it.
const std::string& KindText(const Job& job);

// A problem document with what finds its job in the log: job_id, request_id and trace_id of the request that
// brought it.
nlohmann::json ProblemOfJob(nlohmann::json problem, const Job& job);

// 128 bits that nobody guesses, as 32 hexadecimal digits.
std::string RandomId();

}  // namespace facetless
