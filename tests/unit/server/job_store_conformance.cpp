#include "tests/unit/server/job_store_conformance.h"

#include <set>
#include <thread>

#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

using testing::ElementsAre;

TEST_P(JobStoreConformance, AJobGoesFromQueuedToDoneAndStaysThere) {
  const Job queued = Submit(Asking("a")).job;
  EXPECT_EQ(queued.id.size(), 32u);
  EXPECT_EQ(jobs().Find(queued.id)->state, JobState::kQueued);
  EXPECT_EQ(jobs().Counts().queued, 1);
  const Job running = Claim().value();
  EXPECT_EQ(running.id, queued.id);
  EXPECT_EQ(running.attempts, 1);
  EXPECT_EQ(running.request.at("question"), "a");
  EXPECT_EQ(jobs().Find(queued.id)->state, JobState::kRunning);
  EXPECT_EQ(jobs().Counts().running, 1);
  EXPECT_TRUE(Finish(running));
  EXPECT_EQ(jobs().Find(queued.id)->state, JobState::kDone);
  EXPECT_EQ(jobs().Find(queued.id)->result, "/answer/x");
  EXPECT_FALSE(Finish(running, JobState::kFailed)) << "the job had already ended";
  EXPECT_FALSE(Claim().has_value());
  EXPECT_FALSE(jobs().Find("nonsense").has_value());
}

TEST_P(JobStoreConformance, TheSameQuestionAtOnceIsOneJobAndLaterAnother) {
  const Job first = Submit(Asking("a")).job;
  EXPECT_EQ(Submit(Asking("a")).job.id, first.id);
  EXPECT_EQ(Outcome(Asking("a", "somebody else")), SubmitOutcome::kAccepted)
      << "who may not see the first one";
  const Job running = Claim().value();
  EXPECT_EQ(Submit(Asking("a")).outcome, SubmitOutcome::kSame);
  ASSERT_TRUE(Finish(running));
  EXPECT_EQ(Submit(Asking("a")).outcome, SubmitOutcome::kAccepted);
}

TEST_P(JobStoreConformance, ARetryKeyStandsForOneSubmission) {
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
  EXPECT_EQ(Outcome(other), SubmitOutcome::kAccepted) << "each owner has idempotency keys of their own";
}

TEST_P(JobStoreConformance, AKnownAnswerMakesAJobThatIsDone) {
  NewJob job = Asking("a");
  job.retry_key = "key";
  job.result = "/answer/a";
  const Job done = Submit(job).job;
  EXPECT_EQ(done.state, JobState::kDone);
  EXPECT_EQ(jobs().Find(done.id)->result, "/answer/a");
  EXPECT_FALSE(Claim().has_value());
}

TEST_P(JobStoreConformance, IsBoundedForAllAndForEach) {
  Open({.queued = 3, .queued_of_owner = 2});
  EXPECT_EQ(Outcome(Asking("a", "anna")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("b", "anna")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("c", "anna")), SubmitOutcome::kShareFull);
  EXPECT_EQ(Outcome(Asking("c", "bert")), SubmitOutcome::kAccepted);
  EXPECT_EQ(Outcome(Asking("d", "bert")), SubmitOutcome::kQueueFull);
  EXPECT_EQ(Outcome(Asking("a", "anna")), SubmitOutcome::kSame)
      << "a repeated question takes no place in the queue";
  ASSERT_TRUE(Claim().has_value());
  EXPECT_EQ(Outcome(Asking("d", "bert")), SubmitOutcome::kAccepted)
      << "a running job takes no place in the queue";
}

TEST_P(JobStoreConformance, OwnersTakeTurns) {
  for (const char* question : {"a1", "a2", "a3", "a4"}) Submit(Asking(question, "anna"));
  Submit(Asking("b1", "bert"));
  EXPECT_EQ(Next(), "a1");
  EXPECT_EQ(Next(), "b1") << "anna's four jobs must not come first";
  Submit(Asking("b2", "bert"));
  Submit(Asking("c1", "cleo"));
  std::vector<std::string> order;
  for (std::string next; !(next = Next()).empty();) order.push_back(next);
  EXPECT_THAT(order, ElementsAre("c1", "a2", "b2", "a3", "a4"));
}

TEST_P(JobStoreConformance, ACrashGivesRunningJobsBack) {
  const std::string id = Submit(Asking("a")).job.id;
  const Job before = Claim().value();
  Open();
  ASSERT_TRUE(jobs().Recover().ok());
  EXPECT_EQ(jobs().Find(id)->state, JobState::kQueued);
  const Job after = Claim().value();
  EXPECT_EQ(after.attempts, 2);
  EXPECT_FALSE(Finish(before)) << "the end of a lost attempt must not end the job";
  EXPECT_TRUE(Finish(after));
}

TEST_P(JobStoreConformance, ALeaseThatIsOverGivesTheJobBack) {
  Submit(Asking("a"));
  const Job slow = Claim(/*lease_s=*/-1).value();
  const Job again = Claim().value();
  EXPECT_EQ(again.id, slow.id);
  EXPECT_FALSE(jobs().Renew(slow, kLease).value());
  EXPECT_FALSE(Finish(slow));
  EXPECT_TRUE(jobs().Renew(again, kLease).value());
  EXPECT_FALSE(Claim().has_value()) << "the lease is still valid";
}

TEST_P(JobStoreConformance, GivesUpAfterThreeAttemptsAndSaysSo) {
  const std::string id = Submit(Asking("a")).job.id;
  for (int attempt = 1; attempt <= 3; ++attempt) {
    EXPECT_EQ(Claim().value().attempts, attempt);
    ASSERT_TRUE(jobs().Recover().ok());
  }
  const Job job = jobs().Find(id).value();
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.problem.at("type"), "urn:facetless:problem:gave-up");
  EXPECT_FALSE(Claim().has_value());
}

TEST_P(JobStoreConformance, TheLastAttemptRunsAlone) {
  constexpr double kOver = -1;  // a lease that expires at once
  Submit(Asking("dangerous"));
  Submit(Asking("third"));
  Submit(Asking("other", "bert"));
  ASSERT_EQ(Claim(kOver).value().question, "dangerous");
  const Job other = Claim().value();
  ASSERT_EQ(other.question, "other") << "it must be another owner's turn";
  ASSERT_EQ(Claim(kOver).value().question, "dangerous");
  // While another job runs, this one waits; while it runs, others wait.
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

TEST_P(JobStoreConformance, AReleasedJobWasNotAttempted) {
  Submit(Asking("a"));
  for (int i = 0; i < 5; ++i) {
    const Job job = Claim().value();
    EXPECT_EQ(job.attempts, 1);
    EXPECT_TRUE(jobs().Release(job).value());
  }
}

TEST_P(JobStoreConformance, CancelsWhatWaitsAtOnceAndWhatRunsEvenThroughACrash) {
  const std::string waiting = Submit(Asking("a")).job.id;
  EXPECT_EQ(jobs().Cancel(waiting).value()->state, JobState::kCancelled);
  EXPECT_FALSE(Claim().has_value());
  const std::string running = Submit(Asking("b")).job.id;
  ASSERT_TRUE(Claim().has_value());
  EXPECT_EQ(jobs().Cancel(running).value()->state, JobState::kRunning);
  ASSERT_TRUE(jobs().Recover().ok());
  EXPECT_EQ(jobs().Find(running)->state, JobState::kCancelled) << "a cancelled job must not be tried again";
  EXPECT_FALSE(jobs().Cancel("nonsense").value().has_value());
}

TEST_P(JobStoreConformance, ForgetsWhatEndedLongAgo) {
  const std::string ended = Submit(Asking("a")).job.id, waiting = Submit(Asking("b")).job.id;
  ASSERT_TRUE(Finish(Claim().value()));
  ASSERT_TRUE(jobs().Forget(WallClock() - 100).ok());
  EXPECT_TRUE(jobs().Find(ended).has_value());
  ASSERT_TRUE(jobs().Forget(WallClock() + 100).ok());
  EXPECT_FALSE(jobs().Find(ended).has_value());
  EXPECT_TRUE(jobs().Find(waiting).has_value());
}

TEST_P(JobStoreConformance, ManyWorkersShareItWithoutTakingAJobTwice) {
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
