#include "server/service/jobs/run_job.h"

#include <utility>

#include "server/base/sha256.h"
#include "server/service/jobs/job_inputs.h"
#include "server/service/jobs/job_kinds.h"
#include "server/service/jobs/publication.h"
#include "server/service/jobs/submission.h"

namespace facetless {
Result<std::string> RunJob(const Job& job, Store& store, const RunLimits& limits, const JobWatch& watch) {
  if (job.kind == JobKind::kUnknown)
    return Error{ErrorCode::kInternal,
                 "the store has a job of the kind \"" + job.unknown_kind +
                     "\", which this version of Facetless does not know: a newer version "
                     "put it there, and can run it"};
  const JobKindRow& row = RowOf(job.kind);
  auto request = ParseJobRequest(job.request);
  if (!request) return request.error();
  const bool answers = row.run != nullptr;
  if (answers && store.FindAnswer(job.owner, job.question)) return AnswerItem(job.owner, job.question);

  // The limits may have been lowered while the job waited for a restart of the service.
  if (answers)
    if (auto small = CheckSamples(request.value().options, limits.max_samples); !small) return small.error();
  JobInputs inputs(job, std::move(request).value(), store, limits, watch);
  if (auto made = inputs.MakeModel(); !made) return made.error();
  if (!answers) return ModelItem(job.owner, inputs.stored().id);

  // Run the job in a directory of its own, and then move its files into the store.
  auto scratch = store.Scratch();
  if (!scratch) return scratch.error();
  const std::string directory = scratch.value().File("out");
  auto result = row.run(inputs, directory);
  if (!result) return result.error();
  if (watch.observer != nullptr && watch.observer->traced)
    for (const TracedRays& pass : result.value().traced) watch.observer->traced(pass.rays, pass.seconds);
  if (watch.progress) watch.progress("publish", 0);
  // If time, memory or threads ran out, the exact half is the answer of this job only, and later jobs try
  // again.
  const auto& none = result.value().no_baseline;
  const std::string key = none && !LiesInFile(*none) ? Sha256Hex(job.question + job.id) : job.question;
  if (auto published =
          PublishRun(store, job.owner, key, inputs.stored().id, std::move(result).value(), directory);
      !published)
    return published.error();
  return AnswerItem(job.owner, key);
}

}  // namespace facetless
