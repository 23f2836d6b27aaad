// The laws of the queue (job_store.h), without anything that runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "server/service/jobs/sql_job_store.h"
#include "tests/unit/server/support.h"

namespace facetless {
namespace {

using testing::ElementsAre;

constexpr double kLease = 60;

class Queue : public testing::Test {
 protected:
  Queue() { Open(); }
  void Open(const QueueLimits& limits = {}) {
    jobs_.reset();
    directory_.reset();
    directory_ = DataDirectory::Open(folder_.path()).value();
    jobs_ = std::make_unique<SqlJobStore>(*directory_, limits);
  }
  static NewJob Asking(const std::string& question, const std::string& owner = "") {
    NewJob job;
    job.kind = "render";
    job.owner = owner;
    job.question = question;
    job.request = {{"question", question}};
    return job;
  }
  Submitted Submit(const NewJob& job) { return jobs_->Submit(job).value(); }
  SubmitOutcome Outcome(const NewJob& job) { return Submit(job).outcome; }
  std::optional<Job> Claim(double lease_s = kLease) { return jobs_->Claim("worker", lease_s).value(); }
  // The question of the next claim; "" if there is none.
  std::string Next() {
    const auto job = Claim();
    return job ? job->question : "";
  }
  bool Finish(Job job, JobState state = JobState::kDone) {
    job.state = state;
    if (state == JobState::kDone) job.result = "/answer/x";
    if (state == JobState::kFailed) job.problem = {{"status", 422}};
    return jobs_->Finish(job).value();
  }

  TempDir folder_ = TempDir::Create().value();
  std::unique_ptr<DataDirectory> directory_;
  std::unique_ptr<SqlJobStore> jobs_;
};

TEST_F(Queue, AJobGoesFromQueuedToDoneAndStaysThere) {
  const Job queued = Submit(Asking("a")).job;
  EXPECT_EQ(queued.id.size(), 32u);
  EXPECT_EQ(jobs_->Find(queued.id)->state, JobState::kQueued);
  EXPECT_EQ(jobs_->Counts().queued, 1);
  const Job running = Claim().value();
  EXPECT_EQ(running.id, queued.id);
  EXPECT_EQ(running.attempts, 1);
  EXPECT_EQ(running.request.at("question"), "a");
  EXPECT_EQ(jobs_->Find(queued.id)->state, JobState::kRunning);
  EXPECT_EQ(jobs_->Counts().running, 1);
  EXPECT_TRUE(Finish(running));
  EXPECT_EQ(jobs_->Find(queued.id)->state, JobState::kDone);
  EXPECT_EQ(jobs_->Find(queued.id)->result, "/answer/x");
  EXPECT_FALSE(Finish(running, JobState::kFailed)) << "it ended already";
  EXPECT_FALSE(Claim().has_value());
  EXPECT_FALSE(jobs_->Find("nonsense").has_value());
}

TEST_F(Queue, IdsAreNotGuessable) {
  std::set<std::string> ids;
  for (int i = 0; i < 100; ++i) ids.insert(RandomId());
  EXPECT_EQ(ids.size(), 100u);
  for (const std::string& id : ids)
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
}

TEST_F(Queue, TheSameQuestionAtOnceIsOneJobAndLaterAnother) {
  const Job first = Submit(Asking("a")).job;
  EXPECT_EQ(Submit(Asking("a")).job.id, first.id);
  EXPECT_EQ(Outcome(Asking("a", "somebody else")), SubmitOutcome::kAccepted)
      << "who may not see the first one";
  const Job running = Claim().value();
  EXPECT_EQ(Submit(Asking("a")).outcome, SubmitOutcome::kSame);
  ASSERT_TRUE(Finish(running));
  EXPECT_EQ(Submit(Asking("a")).outcome, SubmitOutcome::kAccepted);
}

TEST_F(Queue, ARetryKeyStandsForOneSubmission) {
  NewJob job = Asking("a");
  job.retry_key = "key";
  job.body = "body";
  const Job first = Submit(job).job;
  ASSERT_TRUE(Finish(Claim().value()));
  EXPECT_EQ(Submit(job).outcome, SubmitOutcome::kSame);
  EXPECT_EQ(Submit(job).job.id, first.id);
  NewJob other = Asking("b");
  other.retry_key = "key";
  other.body = "another body";
  EXPECT_EQ(Outcome(other), SubmitOutcome::kKeyReused);
  other.owner = "somebody else";
  EXPECT_EQ(Outcome(other), SubmitOutcome::kAccepted) << "keys are each owner's own";
}

TEST_F(Queue, AKnownAnswerMakesAJobThatIsDone) {
  NewJob job = Asking("a");
  job.retry_key = "key";
  job.result = "/answer/a";
  const Job done = Submit(job).job;
  EXPECT_EQ(done.state, JobState::kDone);
  EXPECT_EQ(jobs_->Find(done.id)->result, "/answer/a");
  EXPECT_FALSE(Claim().has_value());
}

TEST_F(Queue, IsBoundedForAllAndForEach) {
  Open({.queued = 3, .queued_of_owner = 2});
  EXPECT_EQ(Outcome(Asking("a", "anna")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("b", "anna")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("c", "anna")), SubmitOutcome::kShareFull);
  EXPECT_EQ(Outcome(Asking("c", "bert")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("d", "bert")), SubmitOutcome::kQueueFull);
  EXPECT_EQ(Outcome(Asking("a", "anna")), SubmitOutcome::kSame) << "takes no place";
  ASSERT_TRUE(Claim().has_value());
  EXPECT_EQ(Outcome(Asking("d", "bert")), SubmitOutcome::kAccepted) << "what runs does not wait";
}

TEST_F(Queue, OwnersTakeTurns) {
  for (const char* question : {"a1", "a2", "a3", "a4"}) Submit(Asking(question, "anna"));
  Submit(Asking("b1", "bert"));
  EXPECT_EQ(Next(), "a1");
  EXPECT_EQ(Next(), "b1") << "anna's four don't come first";
  Submit(Asking("b2", "bert"));
  Submit(Asking("c1", "cleo"));
  std::vector<std::string> order;
  for (std::string next; !(next = Next()).empty();) order.push_back(next);
  EXPECT_THAT(order, ElementsAre("c1", "a2", "b2", "a3", "a4"));
}

TEST_F(Queue, ACrashGivesRunningJobsBack) {
  const std::string id = Submit(Asking("a")).job.id;
  const Job before = Claim().value();
  Open();
  ASSERT_TRUE(jobs_->Recover().ok());
  EXPECT_EQ(jobs_->Find(id)->state, JobState::kQueued);
  const Job after = Claim().value();
  EXPECT_EQ(after.attempts, 2);
  EXPECT_FALSE(Finish(before)) << "the dead attempt's end is not the job's";
  EXPECT_TRUE(Finish(after));
}

TEST_F(Queue, ALeaseThatIsOverGivesTheJobBack) {
  Submit(Asking("a"));
  const Job slow = Claim(/*lease_s=*/-1).value();
  const Job again = Claim().value();
  EXPECT_EQ(again.id, slow.id);
  EXPECT_FALSE(jobs_->Renew(slow, kLease).value());
  EXPECT_FALSE(Finish(slow));
  EXPECT_TRUE(jobs_->Renew(again, kLease).value());
  EXPECT_FALSE(Claim().has_value()) << "the lease is good";
}

TEST_F(Queue, GivesUpAfterThreeAttemptsAndSaysSo) {
  const std::string id = Submit(Asking("a")).job.id;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    EXPECT_EQ(Claim().value().attempts, attempt);
    ASSERT_TRUE(jobs_->Recover().ok());
  }
  const Job job = jobs_->Find(id).value();
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.problem.at("type"), "urn:facetless:problem:gave-up");
  EXPECT_FALSE(Claim().has_value());
}

TEST_F(Queue, TheLastAttemptRunsAlone) {
  Submit(Asking("dangerous"));
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(Next(), "dangerous");
    ASSERT_TRUE(jobs_->Recover().ok());
  }
  // While another runs, it waits; while it runs, others wait.
  Submit(Asking("other"));
  Submit(Asking("third"));
  ASSERT_TRUE(directory_->writer().Run("UPDATE jobs SET number = -1 WHERE question = 'other'").ok());
  const Job other = Claim().value();
  EXPECT_EQ(other.question, "other");
  const Job third = Claim().value();
  EXPECT_EQ(third.question, "third");
  EXPECT_FALSE(Claim().has_value());
  ASSERT_TRUE(Finish(other));
  ASSERT_TRUE(Finish(third));
  Submit(Asking("fourth"));
  const Job last = Claim().value();
  EXPECT_EQ(last.question, "dangerous");
  EXPECT_FALSE(Claim().has_value());
  ASSERT_TRUE(Finish(last));
  EXPECT_EQ(Next(), "fourth");
}

TEST_F(Queue, AReleasedJobWasNotAttempted) {
  Submit(Asking("a"));
  for (int i = 0; i < 5; ++i) {
    const Job job = Claim().value();
    EXPECT_EQ(job.attempts, 1);
    EXPECT_TRUE(jobs_->Release(job).value());
  }
}

TEST_F(Queue, CancelsWhatWaitsAtOnceAndWhatRunsEvenThroughACrash) {
  const std::string waiting = Submit(Asking("a")).job.id;
  EXPECT_EQ(jobs_->Cancel(waiting).value()->state, JobState::kCancelled);
  EXPECT_FALSE(Claim().has_value());
  const std::string running = Submit(Asking("b")).job.id;
  ASSERT_TRUE(Claim().has_value());
  EXPECT_EQ(jobs_->Cancel(running).value()->state, JobState::kRunning);
  ASSERT_TRUE(jobs_->Recover().ok());
  EXPECT_EQ(jobs_->Find(running)->state, JobState::kCancelled) << "and is not tried again";
  EXPECT_FALSE(jobs_->Cancel("nonsense").value().has_value());
}

TEST_F(Queue, ForgetsWhatEndedLongAgo) {
  const std::string ended = Submit(Asking("a")).job.id, waiting = Submit(Asking("b")).job.id;
  ASSERT_TRUE(Finish(Claim().value()));
  ASSERT_TRUE(jobs_->Forget(WallClock() - 100).ok());
  EXPECT_TRUE(jobs_->Find(ended).has_value());
  ASSERT_TRUE(jobs_->Forget(WallClock() + 100).ok());
  EXPECT_FALSE(jobs_->Find(ended).has_value());
  EXPECT_TRUE(jobs_->Find(waiting).has_value());
}

TEST_F(Queue, ManyWorkersShareItWithoutTakingAJobTwice) {
  constexpr int kJobs = 60;
  Open({.queued = kJobs, .queued_of_owner = kJobs});
  for (int i = 0; i < kJobs; ++i) Submit(Asking(std::to_string(i)));
  std::atomic<int> ended{0};
  std::vector<std::thread> workers;
  for (int i = 0; i < 4; ++i) {
    workers.emplace_back([&] {
      while (const auto job = Claim()) ended += Finish(*job) ? 1 : 0;
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(ended, kJobs);
}

}  // namespace
}  // namespace facetless
