// The job store: the queue of jobs, their owners and their results. sql_job_store.h implements it with
// SQLite. An implementation for several machines would obey the same laws.
//
//     Result<Submitted> submitted = jobs.Submit({.kind = "render", .owner = caller.owner});
//     Result<std::optional<Job>> job = jobs.Claim("worker-1", /*lease_s=*/30);
//
//  1. A job is first `queued`, then `running`, and finally and permanently `done`, `failed` or `cancelled`. A
//     submitted job survives a crash of the process or the machine. A running job becomes `queued` again when
//     its lease has expired or when its process is known to be dead.
//  2. Every claim is an attempt with its own number. Only the latest attempt may renew, finish or release the
//     job. The results of earlier attempts are refused, so a job ends exactly once.
//  3. A job fails after `max_attempts` attempts without an end. Its last attempt runs alone, so that a job
//     that kills the process does not end other jobs every time.
//  4. Claims alternate between the owners that have waiting jobs. The jobs of one owner are claimed in the
//     order of submission.
//  5. Two jobs of one owner with the same question are never queued or running at the same time, and each
//     retry key of an owner belongs to one job.
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

// The name of a state: "queued", "running", "done", "failed" or "cancelled".
const char* JobStateName(JobState state);

struct Job {
  std::string id;  // 128 random bits, hexadecimal
  JobKind kind = JobKind::kModel;
  std::string unknown_kind;  // for kUnknown: the name in the store
  std::string owner;         // the id of a key; "" where there are none
  std::string question;      // digest of what is asked
  nlohmann::json request;    // what is asked, in full
  JobState state = JobState::kQueued;
  double created = 0, started = 0, finished = 0;  // seconds since 1970; 0: not yet
  int attempts = 0;
  std::string result;      // done: the item that contains the answer (store.h)
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
  std::vector<std::string> needs;  // items that the store must keep until the job ends
  std::string retry_key;           // the caller's Idempotency-Key; empty: none
  std::string body;                // digest of the submission; compared if the retry key is known
  std::string result;              // not empty: the answer exists already, and the job is done
};

enum class SubmitOutcome {
  kAccepted,
  kSame,       // there is an earlier job with this question or this retry key
  kKeyReused,  // the retry key belongs to another submission
  kQueueFull,
  kShareFull,  // this owner has reached the limit of waiting jobs per owner
};

struct Submitted {
  SubmitOutcome outcome = SubmitOutcome::kAccepted;
  Job job;  // kAccepted, kSame
};

struct QueueLimits {
  int queued = 64;           // waiting jobs of all owners
  int queued_of_owner = 64;  // waiting jobs of one owner that has a key
  int max_attempts = 3;
};

struct JobCounts {
  int queued = 0, running = 0;
};

class JobStore {
 public:
  virtual ~JobStore() = default;

  // Submits a job. The job is committed when the function returns. Errors: kWriteFailed.
  virtual Result<Submitted> Submit(const NewJob& job) = 0;

  // Claims the next job for `worker`, with a lease of `lease_s` seconds; nothing if there is no job to run.
  virtual Result<std::optional<Job>> Claim(const std::string& worker, double lease_s) = 0;
  // Renews the lease. `job` is the result of Claim. Returns false if the attempt is not the latest one; its
  // work must then stop.
  virtual Result<bool> Renew(const Job& job, double lease_s) = 0;
  // Ends the job with job.state, job.result and job.problem. Returns false if the attempt is not the latest
  // one.
  virtual Result<bool> Finish(const Job& job) = 0;
  // Returns the job to the queue, as if it had not been claimed.
  virtual Result<bool> Release(const Job& job) = 0;

  // Cancels a queued job. For a running job, records that it is to be cancelled, whatever happens to its
  // process. Returns the job after that; nothing if there is no such job.
  virtual Result<std::optional<Job>> Cancel(const std::string& id) = 0;
  virtual std::optional<Job> Find(const std::string& id) = 0;
  // The ids of at most `limit` jobs of an owner, newest first, starting with the first job older than `after`
  // ("" starts with the newest job). Nothing if the owner has no job `after`.
  virtual std::optional<std::vector<std::string>> List(const std::string& owner, const std::string& after,
                                                       std::size_t limit) = 0;
  virtual JobCounts Counts() = 0;

  // Succeeds if the store can accept a job. Errors: the errors of Submit.
  virtual Result<void> Check() = 0;

  // Returns every running job to the queue, or lets it fail (law 3), whatever its lease. Call this only when
  // no other process can be running jobs.
  virtual Result<void> Recover() = 0;
  // Deletes jobs that ended before `finished_before`, and the oldest jobs beyond a limit of the
  // implementation.
  virtual Result<void> Forget(double finished_before) = 0;
};

// The name of the job's kind, such as "comparison"; for an unknown kind, the name in the store.
const std::string& KindText(const Job& job);

// The problem document with the ids that identify the job in the log: its job_id, and the request_id and
// trace_id of the request that submitted it.
nlohmann::json JobProblem(nlohmann::json problem, const Job& job);

// 128 unpredictable random bits, as 32 hexadecimal digits.
std::string RandomId();

}  // namespace facetless
