#include "server/service/jobs/jobs.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>
#include <utility>

#include "server/base/heap.h"
#include "server/base/interrupt.h"
#include "server/service/protocol/problem.h"
#include "server/service/store/data_directory.h"

namespace facetless {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

// Lease duration, in seconds. Workers renew after a quarter of it; a worker that misses the deadline loses
// its jobs.
constexpr double kLeaseSeconds = 60;
constexpr double kRenewSeconds = kLeaseSeconds / 4;
// The interval at which workers look for jobs without being notified, because expired leases of other
// processes cause no notification.
constexpr auto kLookSeconds = std::chrono::seconds(1);
constexpr double kSweepSeconds = 60;
// The time that Cancel waits for the work to end, which usually takes a few hundredths of it.
constexpr double kCancelSeconds = 1;
// The number of attempts to store the end of a job, for example on a full disk. It covers the time for which
// the lease is certain to last.
constexpr int kEndTries = 30;

Clock::time_point After(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
}

// Removes the directories of paths that begin with `prefix`, so that messages name files but not their
// locations.
std::string StripDirectories(std::string message, const std::string& prefix) {
  if (prefix.empty()) return message;
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) {
    const std::size_t end = std::min(message.find_first_of(" :,;\"'", at), message.size());
    const std::size_t slash = message.rfind('/', end - 1);
    message.erase(at, slash + 1 - at);
  }
  return message;
}

}  // namespace

struct Jobs::Active {
  Job job;
  std::atomic<bool> stop{false};       // ends the work; the flags below have the reason
  std::atomic<bool> cancelled{false};  // a client cancelled the job
  std::string stage = "starting";
  double fraction = 0;
  std::vector<std::string> messages;
  std::uint64_t version = 0;
  const Clock::time_point began = Clock::now();
  Clock::time_point stage_began = began;
};

Jobs::Jobs(JobStore& queue, Store& store, const JobSettings& settings)
    : queue_(queue), store_(store), settings_(settings), worker_(RandomId()) {
  (void)queue_.Recover();
  for (int i = 0; i < settings.workers; ++i) threads_.emplace_back([this] { Work(); });
  threads_.emplace_back([this] { MaintainLeases(); });
}

Jobs::~Jobs() {
  Stop(0);
}

void Jobs::Stop(double grace_s) {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  ++changes_;
  changed_.notify_all();
  changed_.wait_until(lock, After(grace_s), [this] { return active_.empty(); });
  for (const auto& [id, active] : active_) active->stop = true;
  ending_ = true;
  ++changes_;
  changed_.notify_all();
  std::vector<std::thread> threads;
  threads.swap(threads_);
  lock.unlock();
  for (std::thread& thread : threads) thread.join();
}

Result<Submitted> Jobs::Submit(const NewJob& job) {
  auto submitted = queue_.Submit(job);
  if (!submitted) return submitted;
  const std::lock_guard lock(mutex_);
  ++arrivals_;
  changed_.notify_all();
  return submitted;
}

// ---- Working ----

void Jobs::Work() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    // Claim the job and register it as active in one step, so that Cancel finds it either queued or active.
    const std::uint64_t seen = arrivals_;
    auto claimed = queue_.Claim(worker_, kLeaseSeconds);
    if (!claimed || !claimed.value()) {
      changed_.wait_for(lock, kLookSeconds, [&] { return stopping_ || arrivals_ != seen; });
      continue;
    }
    auto active = std::make_shared<Active>();
    active->job = std::move(*claimed.value());
    active->version = ++changes_;
    if (active->job.attempts > 1)
      active->messages.push_back("attempt " + std::to_string(active->job.attempts) +
                                 ": the service ended during an earlier one");
    active_[active->job.id] = active;
    changed_.notify_all();
    lock.unlock();
    Run(active);
    lock.lock();
    active_.erase(active->job.id);
    // Another job may have had to wait for the end of this one.
    ++arrivals_;
    ++changes_;
    changed_.notify_all();
  }
}

void Jobs::Run(const std::shared_ptr<Active>& active) {
  const Deadline deadline(settings_.run.timeout_s, &active->stop);
  JobWatch watch;
  watch.deadline = &deadline;
  watch.progress = [&](const std::string& stage, double fraction) {
    const std::lock_guard lock(mutex_);
    if (active->stage == stage && active->fraction == fraction) return;
    EnterStage(*active, stage);
    active->fraction = fraction;
    active->version = ++changes_;
    changed_.notify_all();
  };
  watch.observer = &settings_.observer;
  watch.fork_server = settings_.fork_server;
  watch.message = [&](const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    active->messages.push_back(sentence);
    active->version = ++changes_;
    changed_.notify_all();
  };
  Result<std::string> result = Error{ErrorCode::kInternal, "the job failed with an unknown exception"};
  try {
    result = RunJob(active->job, store_, settings_.run, watch);
  } catch (const std::bad_alloc&) {
    result = Error{ErrorCode::kLimitExceeded, "the service ran out of memory while this job ran"};
  } catch (const std::exception&) {
    // The message of the exception is not useful for callers, and may contain internal information.
  }
  EnterStage(*active, "");
  RecordEnd(Ended(*active, result, deadline.expired()), Seconds(Clock::now() - active->began).count());
  store_.Sweep();
  ReleaseFreeMemory();
}

// Enters a stage, and reports the duration of the previous one.
void Jobs::EnterStage(Active& active, const std::string& stage) const {
  if (active.stage == stage) return;
  const auto now = Clock::now();
  if (settings_.observer.stage_ended)
    settings_.observer.stage_ended(active.stage, Seconds(now - active.stage_began).count());
  active.stage_began = now;
  if (!stage.empty()) active.stage = stage;
}

Job Jobs::Ended(const Active& active, const Result<std::string>& result, bool expired) const {
  Job job = active.job;
  if (result) {
    job.state = JobState::kDone;
    job.result = result.value();
    return job;
  }
  const Error& error = result.error();
  job.state = JobState::kFailed;
  HttpResponse problem;
  if (error.code != ErrorCode::kCancelled) {
    problem = ProblemForError({error.code, StripDirectories(error.message, settings_.private_directory)});
  } else if (expired) {
    problem =
        Problem(504, "timeout", "The request took too long",
                "It was stopped after " + std::to_string(static_cast<long>(settings_.run.timeout_s)) + " s.");
  } else {
    // The job was cancelled by a client, or is returned to the queue because the service stops.
    job.state = active.cancelled ? JobState::kCancelled : JobState::kQueued;
    return job;
  }
  job.problem =
      JobProblem(nlohmann::json::parse(problem.body, nullptr, /*allow_exceptions=*/false), active.job);
  return job;
}

void Jobs::RecordEnd(Job ended, double seconds) {
  for (int i = 0; i < kEndTries; ++i) {
    const auto recorded = ended.state == JobState::kQueued ? queue_.Release(ended) : queue_.Finish(ended);
    if (recorded) {
      ended.finished = WallClock();
      if (recorded.value() && ended.Ended() && settings_.observer.job_ended)
        settings_.observer.job_ended(ended, seconds);
      return;
    }
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, kLookSeconds, [this] { return ending_; })) return;
  }
}

void Jobs::MaintainLeases() {
  auto renew = After(kRenewSeconds), sweep = After(kSweepSeconds);
  std::unique_lock lock(mutex_);
  while (!ending_) {
    changed_.wait_until(lock, std::min(renew, sweep), [this] { return ending_; });
    const auto active = active_;
    lock.unlock();
    if (Clock::now() >= renew) {
      renew = After(kRenewSeconds);
      for (const auto& [id, one] : active) {
        // Another worker has the job now; two workers must not run it.
        const auto renewed = queue_.Renew(one->job, kLeaseSeconds);
        if (renewed && !renewed.value()) one->stop = true;
      }
    }
    if (Clock::now() >= sweep) {
      sweep = After(kSweepSeconds);
      store_.Sweep();
      (void)queue_.Forget(settings_.forget_after_s > 0 ? WallClock() - settings_.forget_after_s : 0);
    }
    lock.lock();
  }
}

// ---- Watching ----

std::optional<JobView> Jobs::Find(const std::string& id) {
  JobView view;
  bool active = false;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = active_.find(id); found != active_.end()) {
      active = true;
      view.stage = found->second->stage;
      view.fraction = found->second->fraction;
      view.messages = found->second->messages;
      view.version = found->second->version;
    }
  }
  // Read the job after its progress, so that an end in between is noticed.
  auto job = queue_.Find(id);
  if (!job) return std::nullopt;
  view.job = std::move(*job);
  if (view.job.Ended() || !active) {
    view.stage = view.job.state == JobState::kRunning ? "starting" : JobStateName(view.job.state);
    view.fraction = view.job.state == JobState::kDone ? 1 : 0;
  }
  return view;
}

std::optional<JobView> Jobs::Wait(const std::string& id, double seconds,
                                  const std::function<bool(const JobView&)>& enough) {
  const auto end = After(seconds);
  while (true) {
    std::uint64_t seen = 0;
    {
      const std::lock_guard lock(mutex_);
      seen = changes_;
    }
    auto view = Find(id);
    if (!view || view->job.Ended() || enough(*view)) return view;
    std::unique_lock lock(mutex_);
    // A job that is not running when the service stops will not run in this process.
    if (ending_ || (stopping_ && !active_.contains(id))) return view;
    if (!changed_.wait_until(lock, end, [&] { return changes_ != seen; })) return view;
  }
}

std::optional<JobView> Jobs::WaitForEnd(const std::string& id, double seconds) {
  return Wait(id, seconds, [](const JobView&) { return false; });
}

std::optional<JobView> Jobs::WaitForChange(const std::string& id, std::uint64_t version, double seconds) {
  return Wait(id, seconds, [version](const JobView& view) { return view.version != version; });
}

Result<std::optional<JobView>> Jobs::Cancel(const std::string& id) {
  const auto before = queue_.Find(id);
  auto job = queue_.Cancel(id);
  if (!job) return job.error();
  if (!job.value()) return std::optional<JobView>();
  // Report the end of a queued job here, because no worker does.
  if (before && before->state == JobState::kQueued && job.value()->state == JobState::kCancelled &&
      settings_.observer.job_ended)
    settings_.observer.job_ended(*job.value(), 0);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = active_.find(id); found != active_.end()) {
      found->second->cancelled = true;
      found->second->stop = true;
    }
    ++changes_;
    changed_.notify_all();
  }
  return WaitForEnd(id, kCancelSeconds);
}

}  // namespace facetless
