// Tests that the job store in SQLite obeys the laws of the queue.
#include "server/service/jobs/sql_job_store.h"

#include <set>

#include "tests/unit/server/job_store_conformance.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

class SqlJobStoreHost : public JobStoreHost {
 public:
  JobStore& Open(const QueueLimits& limits) override {
    jobs_.reset();
    directory_.reset();
    directory_ = DataDirectory::Open(folder_.path()).value();
    jobs_ = std::make_unique<SqlJobStore>(*directory_, limits);
    return *jobs_;
  }

 private:
  TempDir folder_ = TempDir::Create().value();
  std::unique_ptr<DataDirectory> directory_;
  std::unique_ptr<SqlJobStore> jobs_;
};

std::unique_ptr<JobStoreHost> MakeSqlJobStoreHost() {
  return std::make_unique<SqlJobStoreHost>();
}

INSTANTIATE_TEST_SUITE_P(Sqlite, JobStoreConformance, testing::Values(&MakeSqlJobStoreHost));

TEST(RandomId, IsNotGuessable) {
  std::set<std::string> ids;
  for (int i = 0; i < 100; ++i) ids.insert(RandomId());
  EXPECT_EQ(ids.size(), 100u);
  for (const std::string& id : ids)
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
}

}  // namespace
}  // namespace facetless
