// A JobStore that uses the database of a data directory.
#pragma once

#include "server/service/jobs/job_store.h"
#include "server/service/store/data_directory.h"

namespace facetless {

class SqlJobStore : public JobStore {
 public:
  // `directory` must outlive the store.
  SqlJobStore(DataDirectory& directory, const QueueLimits& limits) : directory_(directory), limits_(limits) {}

  Result<Submitted> Submit(const NewJob& job) override;
  Result<std::optional<Job>> Claim(const std::string& worker, double lease_s) override;
  Result<bool> Renew(const Job& job, double lease_s) override;
  Result<bool> Finish(const Job& job) override;
  Result<bool> Release(const Job& job) override;
  Result<std::optional<Job>> Cancel(const std::string& id) override;
  std::optional<Job> Find(const std::string& id) override;
  std::optional<std::vector<std::string>> List(const std::string& owner, const std::string& after,
                                               std::size_t limit) override;
  JobCounts Counts() override;
  Result<void> Check() override;
  Result<void> Recover() override;
  Result<void> Forget(double finished_before) override;

 private:
  Result<std::optional<SubmitOutcome>> FindEarlier(const NewJob& job, Submitted& submitted);
  Result<std::optional<SubmitOutcome>> FindFull(const NewJob& job);
  Result<void> Insert(const NewJob& job, const Job& row);
  Result<void> RequeueRunningJobs(const std::string& which, const std::vector<SqlValue>& values);
  Result<void> DeleteHoldingsOfEndedJobs();

  DataDirectory& directory_;
  const QueueLimits limits_;
};

}  // namespace facetless
