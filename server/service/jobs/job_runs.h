// What each kind of job runs, as its row in job_kinds.cpp says: on inputs that are there, into a directory that
// is its own.
//
//  1. A comparison whose mesh cannot be made has the exact half alone as its answer, and says why in the terms
//     of HTTP, on the way too.
//  2. A trade whose caller names no budget takes a share of the job's time for each point.
#pragma once

#include <string>

#include "render/base/result.h"
#include "server/service/jobs/job_inputs.h"

namespace facetless {

// Errors: those of JobInputs and of the runs (run.h, trade.h).
Result<RunResult> RunRenderJob(JobInputs& inputs, const std::string& directory);
Result<RunResult> RunComparisonJob(JobInputs& inputs, const std::string& directory);
Result<RunResult> RunTradeJob(JobInputs& inputs, const std::string& directory);

}  // namespace facetless
