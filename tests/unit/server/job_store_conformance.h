// Tests the laws of the queue (server/service/jobs/job_store.h) for any implementation. A file of tests
// defines a host of its own, and contains
//
//   INSTANTIATE_TEST_SUITE_P(Sqlite, JobStoreConformance, testing::Values(&MakeSqlJobStoreHost));
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "server/service/jobs/job_store.h"

namespace facetless {

// The place where an implementation stores its jobs. It is empty at first.
class JobStoreHost {
 public:
  virtual ~JobStoreHost() = default;
  // Closes the store that the last call returned, and opens the stored jobs again.
  virtual JobStore& Open(const QueueLimits& limits) = 0;
};

class JobStoreConformance : public testing::TestWithParam<std::unique_ptr<JobStoreHost> (*)()> {
 protected:
  static constexpr double kLease = 60;

  JobStoreConformance() { Open(); }
  void Open(const QueueLimits& limits = {}) { jobs_ = &host_->Open(limits); }
  JobStore& jobs() { return *jobs_; }
  static NewJob Asking(const std::string& question, const std::string& owner = "") {
    NewJob job;
    job.kind = JobKind::kRender;
    job.owner = owner;
    job.question = question;
    job.request = {{"question", question}};
    return job;
  }
  Submitted Submit(const NewJob& job) { return jobs().Submit(job).value(); }
  SubmitOutcome Outcome(const NewJob& job) { return Submit(job).outcome; }
  std::optional<Job> Claim(double lease_s = kLease) { return jobs().Claim("worker", lease_s).value(); }
  // Claims the next job and returns its question; "" if there is none.
  std::string Next() {
    const auto job = Claim();
    return job ? job->question : "";
  }
  bool Finish(Job job, JobState state = JobState::kDone) {
    job.state = state;
    if (state == JobState::kDone) job.result = "/answer/x";
    if (state == JobState::kFailed) job.problem = {{"status", 422}};
    return jobs().Finish(job).value();
  }

 private:
  std::unique_ptr<JobStoreHost> host_ = GetParam()();
  JobStore* jobs_ = nullptr;
};

}  // namespace facetless
