// The functions that run each kind of job, to which the rows in job_kinds.cpp refer. They use inputs that
// have been made, and write into a directory of their own.
//
//  1. If the mesh of a comparison cannot be made, the answer has only the exact half. The answer, and a
//     message while the job runs, give the reason in the terms of HTTP.
//  2. If the caller of a trade gives no budget, each point gets a share of the job's time.
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
