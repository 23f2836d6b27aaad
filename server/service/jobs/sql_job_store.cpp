#include "server/service/jobs/sql_job_store.h"

#include <sys/random.h>

#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "server/base/files.h"

namespace facetless {
namespace {

using Json = nlohmann::json;

// The largest number of ended jobs, with their retry keys. Beyond it, the oldest are deleted.
constexpr std::int64_t kMaxEndedJobs = 100000;

constexpr const char* kColumns =
    "id, kind, owner, question, request, state, created, started, finished, attempts, result, problem";

// The clock of leases, in seconds. It is the monotonic clock of the machine, which no user can set. It
// restarts with the machine, but the service then returns every running job to the queue (Recover).
double LeaseClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

JobState StateFromName(const std::string& name) {
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kDone, JobState::kFailed}) {
    if (name == JobStateName(state)) return state;
  }
  return JobState::kCancelled;
}

Job ReadJobRow(const SqlRow& row) {
  Job job;
  job.id = row.Text(0);
  job.kind = JobKindOf(row.Text(1));
  if (job.kind == JobKind::kUnknown) job.unknown_kind = row.Text(1);
  job.owner = row.Text(2);
  job.question = row.Text(3);
  job.request = Json::parse(row.Text(4), nullptr, /*allow_exceptions=*/false);
  job.state = StateFromName(row.Text(5));
  job.created = row.Real(6);
  job.started = row.Real(7);
  job.finished = row.Real(8);
  job.attempts = static_cast<int>(row.Integer(9));
  job.result = row.Text(10);
  if (!row.IsNull(11)) job.problem = Json::parse(row.Text(11), nullptr, /*allow_exceptions=*/false);
  return job;
}

Result<std::optional<Job>> SelectJob(Database& database, const std::string& condition,
                                     const std::vector<SqlValue>& values) {
  std::optional<Job> job;
  const auto asked =
      database.Query(std::string("SELECT ") + kColumns + " FROM jobs WHERE " + condition + " LIMIT 1", values,
                     [&](const SqlRow& row) { job = ReadJobRow(row); });
  if (!asked) return asked.error();
  return job;
}

SqlValue TextOrNull(const std::string& text) {
  return text.empty() ? SqlValue(nullptr) : SqlValue(text);
}

Json GaveUpProblem(int attempts) {
  return {{"type", "urn:facetless:problem:gave-up"},
          {"title", "The job was given up"},
          {"status", 500},
          {"detail", "The service ended " + std::to_string(attempts) +
                         " times while this job ran, so it is not tried again."}};
}

}  // namespace

const char* JobStateName(JobState state) {
  constexpr const char* kNames[] = {"queued", "running", "done", "failed", "cancelled"};
  return kNames[static_cast<int>(state)];
}

const std::string& KindText(const Job& job) {
  return job.kind == JobKind::kUnknown ? job.unknown_kind : JobKindName(job.kind);
}

Json JobProblem(Json problem, const Job& job) {
  problem["job_id"] = job.id;
  if (!job.request.is_object()) return problem;
  for (const char* name : {"request_id", "trace_id"}) {
    if (job.request.contains(name)) problem[name] = job.request[name];
  }
  return problem;
}

std::string RandomId() {
  std::array<unsigned char, 16> bytes = {};
  // The call cannot fail for so few bytes after the system has started.
  [[maybe_unused]] const auto got = getrandom(bytes.data(), bytes.size(), 0);
  std::string text;
  for (const unsigned char byte : bytes) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

// ---- Submitting ----

Result<Submitted> SqlJobStore::Submit(const NewJob& job) {
  Transaction transaction(directory_.writer());
  if (!transaction.begun()) return transaction.begun().error();
  Submitted submitted;
  auto earlier = FindEarlier(job, submitted);
  if (!earlier) return earlier.error();
  if (!earlier.value() && job.result.empty()) {
    earlier = FindFull(job);
    if (!earlier) return earlier.error();
  }
  if (earlier.value()) {
    submitted.outcome = *earlier.value();
    if (auto committed = transaction.Commit(); !committed) return committed.error();
    return submitted;
  }

  Job& row = submitted.job;
  row.id = RandomId();
  row.kind = job.kind;
  row.owner = job.owner;
  row.question = job.question;
  row.request = job.request;
  row.created = WallClock();
  row.result = job.result;
  if (!job.result.empty()) {
    row.state = JobState::kDone;
    row.started = row.finished = row.created;
  }
  if (auto inserted = Insert(job, row); !inserted) return inserted.error();
  if (auto committed = transaction.Commit(); !committed) return committed.error();
  return submitted;
}

Result<std::optional<SubmitOutcome>> SqlJobStore::FindEarlier(const NewJob& job, Submitted& submitted) {
  Database& database = directory_.writer();
  if (!job.retry_key.empty()) {
    std::string body;
    const auto asked =
        database.Query("SELECT body FROM jobs WHERE owner = ? AND retry_key = ?", {job.owner, job.retry_key},
                       [&](const SqlRow& row) { body = row.Text(0); });
    if (!asked) return asked.error();
    auto known = SelectJob(database, "owner = ? AND retry_key = ?", {job.owner, job.retry_key});
    if (!known) return known.error();
    if (known.value()) {
      submitted.job = std::move(*known.value());
      return std::optional(body == job.body ? SubmitOutcome::kSame : SubmitOutcome::kKeyReused);
    }
  }
  if (!job.result.empty()) return std::optional<SubmitOutcome>();
  auto same = SelectJob(database, "owner = ? AND question = ? AND state IN ('queued', 'running')",
                        {job.owner, job.question});
  if (!same) return same.error();
  if (!same.value()) return std::optional<SubmitOutcome>();
  submitted.job = std::move(*same.value());
  // Give the retry key to the shared job, if it has none yet.
  if (!job.retry_key.empty()) {
    auto named = database.Run("UPDATE jobs SET retry_key = ?, body = ? WHERE id = ? AND retry_key IS NULL",
                              {job.retry_key, job.body, submitted.job.id});
    if (!named) return named.error();
  }
  return std::optional(SubmitOutcome::kSame);
}

Result<std::optional<SubmitOutcome>> SqlJobStore::FindFull(const NewJob& job) {
  std::int64_t all = 0, own = 0;
  const auto asked = directory_.writer().Query(
      "SELECT count(*), coalesce(sum(owner = ?), 0) FROM jobs WHERE state = 'queued'", {job.owner},
      [&](const SqlRow& row) {
        all = row.Integer(0);
        own = row.Integer(1);
      });
  if (!asked) return asked.error();
  if (all >= limits_.queued) return std::optional(SubmitOutcome::kQueueFull);
  if (!job.owner.empty() && own >= limits_.queued_of_owner) return std::optional(SubmitOutcome::kShareFull);
  return std::optional<SubmitOutcome>();
}

Result<void> SqlJobStore::Insert(const NewJob& job, const Job& row) {
  Database& database = directory_.writer();
  const bool ended = row.Ended();
  auto put = database.Run(
      "INSERT INTO jobs(id, kind, owner, question, request, state, created, started, finished, attempts, "
      "cancelling, "
      "result, retry_key, body) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, 0, 0, ?, ?, ?)",
      {row.id, KindText(row), row.owner, row.question, JsonText(row.request, -1), JobStateName(row.state),
       row.created, ended ? SqlValue(row.started) : SqlValue(nullptr),
       ended ? SqlValue(row.finished) : SqlValue(nullptr), TextOrNull(row.result), TextOrNull(job.retry_key),
       job.body});
  if (!put) return put.error();
  if (ended) return {};
  for (const JobFile& file : job.files) {
    put = database.Run("INSERT OR IGNORE INTO files VALUES(?, ?)",
                       {file.sha256, static_cast<std::int64_t>(file.bytes)});
    if (!put) return put.error();
    put = database.Run("INSERT INTO uses VALUES(?, ?, ?)", {"job/" + row.id, file.role, file.sha256});
    if (!put) return put.error();
  }
  for (const std::string& item : job.needs) {
    put = database.Run("INSERT OR IGNORE INTO needs VALUES(?, ?)", {row.id, item});
    if (!put) return put.error();
  }
  return {};
}

// ---- Running ----

Result<std::optional<Job>> SqlJobStore::Claim(const std::string& worker, double lease_s) {
  Database& database = directory_.writer();
  Transaction transaction(database);
  if (!transaction.begun()) return transaction.begun().error();
  const double now = WallClock();
  const auto last = static_cast<std::int64_t>(limits_.max_attempts) - 1;
  if (auto over = RequeueRunningJobs("lease < ?", {LeaseClock()}); !over) return over.error();

  // Select the job of the owner whose turn it is. A last attempt does not start while other jobs run, and no
  // job starts while a last attempt runs.
  auto found = SelectJob(
      database,
      "state = 'queued' AND NOT EXISTS (SELECT 1 FROM jobs r WHERE r.state = 'running' AND r.attempts > ?1 "
      "AND ?1 > 0) "
      "AND (attempts < ?1 OR ?1 = 0 OR NOT EXISTS (SELECT 1 FROM jobs r WHERE r.state = 'running')) "
      "ORDER BY coalesce((SELECT turn FROM turns WHERE turns.owner = jobs.owner), 0), number",
      {last});
  if (!found) return found.error();
  if (!found.value()) {
    if (auto committed = transaction.Commit(); !committed) return committed.error();
    return std::optional<Job>();
  }
  Job job = std::move(*found.value());
  job.state = JobState::kRunning;
  job.started = now;
  ++job.attempts;
  auto put = database.Run(
      "UPDATE jobs SET state = 'running', started = ?, attempts = ?, worker = ?, lease = ? WHERE id = ?",
      {now, static_cast<std::int64_t>(job.attempts), worker, LeaseClock() + lease_s, job.id});
  if (!put) return put.error();
  put = database.Run("INSERT OR REPLACE INTO turns VALUES(?, (SELECT coalesce(max(turn), 0) + 1 FROM turns))",
                     {job.owner});
  if (!put) return put.error();
  if (auto committed = transaction.Commit(); !committed) return committed.error();
  return std::optional(std::move(job));
}

Result<bool> SqlJobStore::Renew(const Job& job, double lease_s) {
  auto put =
      directory_.writer().Run("UPDATE jobs SET lease = ? WHERE id = ? AND state = 'running' AND attempts = ?",
                              {LeaseClock() + lease_s, job.id, static_cast<std::int64_t>(job.attempts)});
  if (!put) return put.error();
  return put.value() > 0;
}

Result<bool> SqlJobStore::Finish(const Job& job) {
  Transaction transaction(directory_.writer());
  if (!transaction.begun()) return transaction.begun().error();
  auto put = directory_.writer().Run(
      "UPDATE jobs SET state = ?, finished = ?, result = ?, problem = ?, worker = NULL, lease = NULL "
      "WHERE id = ? AND state = 'running' AND attempts = ?",
      {JobStateName(job.state), WallClock(), TextOrNull(job.result),
       job.problem.is_null() ? SqlValue(nullptr) : SqlValue(JsonText(job.problem, -1)), job.id,
       static_cast<std::int64_t>(job.attempts)});
  if (!put) return put.error();
  if (put.value() == 0) return false;
  if (auto dropped = DeleteHoldingsOfEndedJobs(); !dropped) return dropped.error();
  if (auto committed = transaction.Commit(); !committed) return committed.error();
  return true;
}

Result<bool> SqlJobStore::Release(const Job& job) {
  auto put = directory_.writer().Run(
      "UPDATE jobs SET state = 'queued', started = NULL, attempts = attempts - 1, worker = NULL, lease = "
      "NULL "
      "WHERE id = ? AND state = 'running' AND attempts = ?",
      {job.id, static_cast<std::int64_t>(job.attempts)});
  if (!put) return put.error();
  return put.value() > 0;
}

Result<std::optional<Job>> SqlJobStore::Cancel(const std::string& id) {
  Database& database = directory_.writer();
  Transaction transaction(database);
  if (!transaction.begun()) return transaction.begun().error();
  auto put =
      database.Run("UPDATE jobs SET state = 'cancelled', finished = ? WHERE id = ? AND state = 'queued'",
                   {WallClock(), id});
  if (!put) return put.error();
  put = database.Run("UPDATE jobs SET cancelling = 1 WHERE id = ? AND state = 'running'", {id});
  if (!put) return put.error();
  if (auto dropped = DeleteHoldingsOfEndedJobs(); !dropped) return dropped.error();
  auto job = SelectJob(database, "id = ?", {id});
  if (!job) return job.error();
  if (auto committed = transaction.Commit(); !committed) return committed.error();
  return job;
}

std::optional<Job> SqlJobStore::Find(const std::string& id) {
  auto job = SelectJob(directory_.reader(), "id = ?", {id});
  return job ? std::move(job).value() : std::nullopt;
}

std::optional<std::vector<std::string>> SqlJobStore::List(const std::string& owner, const std::string& after,
                                                          std::size_t limit) {
  // Numbers are ascending and never reused.
  std::int64_t below = std::numeric_limits<std::int64_t>::max();
  if (!after.empty()) {
    bool found = false;
    (void)directory_.reader().Query("SELECT number FROM jobs WHERE id = ? AND owner = ?", {after, owner},
                                    [&](const SqlRow& row) {
                                      found = true;
                                      below = row.Integer(0);
                                    });
    if (!found) return std::nullopt;
  }
  std::vector<std::string> ids;
  (void)directory_.reader().Query(
      "SELECT id FROM jobs WHERE owner = ? AND number < ? ORDER BY number DESC LIMIT ?",
      {owner, below, static_cast<std::int64_t>(limit)},
      [&](const SqlRow& row) { ids.push_back(row.Text(0)); });
  return ids;
}

JobCounts SqlJobStore::Counts() {
  JobCounts counts;
  (void)directory_.reader().Query(
      "SELECT state, count(*) FROM jobs WHERE state IN ('queued', 'running') GROUP BY state", {},
      [&](const SqlRow& row) {
        (row.Text(0) == "queued" ? counts.queued : counts.running) = static_cast<int>(row.Integer(1));
      });
  return counts;
}

// Checks by acquiring the write lock, which fails if the database is read-only or damaged.
Result<void> SqlJobStore::Check() {
  Transaction transaction(directory_.writer());
  return transaction.begun();
}

// ---- Recovery and maintenance ----

Result<void> SqlJobStore::RequeueRunningJobs(const std::string& which, const std::vector<SqlValue>& values) {
  Database& database = directory_.writer();
  std::vector<Job> lost;
  std::vector<std::string> cancelled;
  auto asked = database.Query(
      std::string("SELECT ") + kColumns + ", cancelling FROM jobs WHERE state = 'running' AND " + which,
      values, [&](const SqlRow& row) {
        if (row.Integer(12) != 0) {
          cancelled.push_back(row.Text(0));
        } else {
          lost.push_back(ReadJobRow(row));
        }
      });
  if (!asked) return asked;
  if (lost.empty() && cancelled.empty()) return {};
  const double now = WallClock();
  for (const std::string& id : cancelled) {
    auto put = database.Run("UPDATE jobs SET state = 'cancelled', finished = ?, lease = NULL WHERE id = ?",
                            {now, id});
    if (!put) return put.error();
  }
  for (const Job& job : lost) {
    auto put =
        job.attempts >= limits_.max_attempts
            ? database.Run(
                  "UPDATE jobs SET state = 'failed', finished = ?, problem = ?, lease = NULL WHERE id = ?",
                  {now, JsonText(JobProblem(GaveUpProblem(job.attempts), job), -1), job.id})
            : database.Run("UPDATE jobs SET state = 'queued', lease = NULL WHERE id = ?", {job.id});
    if (!put) return put.error();
  }
  return DeleteHoldingsOfEndedJobs();
}

Result<void> SqlJobStore::Recover() {
  Transaction transaction(directory_.writer());
  if (!transaction.begun()) return transaction.begun();
  if (auto given = RequeueRunningJobs("1", {}); !given) return given;
  return transaction.Commit();
}

Result<void> SqlJobStore::DeleteHoldingsOfEndedJobs() {
  Database& database = directory_.writer();
  // Only waiting and running jobs have needs and files, so there are few.
  std::vector<std::string> ended;
  auto asked = database.Query(
      "SELECT id FROM jobs WHERE id IN (SELECT job FROM needs UNION SELECT substr(holder, 5) FROM uses "
      "WHERE holder >= 'job/' AND holder < 'job0') AND state NOT IN ('queued', 'running')",
      {}, [&](const SqlRow& row) { ended.push_back(row.Text(0)); });
  if (!asked) return asked;
  for (const std::string& id : ended) {
    if (auto gone = database.Run("DELETE FROM needs WHERE job = ?", {id}); !gone) return gone.error();
    if (auto gone = database.Run("DELETE FROM uses WHERE holder = ?", {"job/" + id}); !gone)
      return gone.error();
  }
  return {};
}

Result<void> SqlJobStore::Forget(double finished_before) {
  auto gone = directory_.writer().Run(
      "DELETE FROM jobs WHERE finished IS NOT NULL AND (finished < ? OR number <= (SELECT max(number) FROM "
      "jobs) - ?)",
      {finished_before, kMaxEndedJobs});
  if (!gone) return gone.error();
  return {};
}

}  // namespace facetless
